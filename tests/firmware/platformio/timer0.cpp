// SPDX-License-Identifier: MIT
// A program without a driver-enable pin, which has the interrupt of Timer0 itself.
#include <fathom_arduino.h>

FathomBus bus(Serial);
FathomA16Auto tank(bus);

ISR(TIMER0_COMPA_vect) {}

void setup()
{
    bus.beginListening(fathom_a16_factory_line);
    tank.begin();
}

void loop()
{
    if (tank.available()) Serial.println(tank.distanceMm());
}
