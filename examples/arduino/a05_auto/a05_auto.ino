// SPDX-License-Identifier: MIT
// A05 with automatic output, UART: TX of the module to pin 10.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial sensorPort(10, 11); // RX, TX
FathomStreamBus bus(sensorPort);
FathomA05Auto bumper(bus);

void setup()
{
    Serial.begin(115200);
    bus.beginListening(fathom_a05_factory_line);
    if (!bumper.begin()) Serial.println(bumper.statusName());
}

void loop()
{
    if (!bumper.available()) return;
    Serial.print(bumper.probe());
    Serial.print(": ");
    if (bumper.hasTarget())
        Serial.println(bumper.distanceMm());
    else
        Serial.println(bumper.resultName());
}
