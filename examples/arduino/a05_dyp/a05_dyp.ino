// SPDX-License-Identifier: MIT
// A05, the protocol 55 AA on RS485. Wiring, resistors, uploading and serial ports: see the sketch hps167s.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial console(10, 11); // RX, TX
FathomBus bus(Serial, 2);
FathomA05Dyp bumper(bus);

void setup()
{
    console.begin(115200);
    bus.begin(fathom_a05_factory_line);
    if (!bumper.begin()) console.println(bumper.statusName());
}

void loop()
{
    if (!bumper.available()) return;
    console.print(bumper.probe());
    console.print(": ");
    if (bumper.hasTarget())
        console.println(bumper.distanceMm());
    else
        console.println(bumper.resultName());
}
