// SPDX-License-Identifier: MIT
// A16 with automatic output, UART: TX of the module to pin 10.
// If a board has Serial1, write FathomBus bus(Serial1) and leave out SoftwareSerial.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial sensorPort(10, 11); // RX, TX
FathomStreamBus bus(sensorPort);
FathomA16Auto tank(bus);

void setup()
{
    Serial.begin(115200);
    bus.beginListening(fathom_a16_factory_line);
    if (!tank.begin()) Serial.println(tank.statusName());
}

void loop()
{
    if (!tank.available()) return;
    if (tank.hasTarget())
        Serial.println(tank.distanceMm());
    else
        Serial.println(tank.resultName());
}
