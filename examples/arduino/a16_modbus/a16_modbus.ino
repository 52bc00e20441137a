// SPDX-License-Identifier: MIT
// A16, Modbus RTU on RS485, with factory settings. fathom_arduino.h has more about the wiring, at class bus.
// DI to TX, RO to RX, DE and /RE to pin 2; 10 kOhm from RO to 5 V, from DE to ground. Disconnect RO while uploading.
// It prints by pin 11, to a USB adapter. With Serial1: write Serial1 for Serial, and Serial for console.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial console(10, 11); // RX, TX
FathomBus bus(Serial, 2);
FathomA16Modbus tank(bus);

void setup()
{
    console.begin(115200);
    bus.begin(fathom_a16_factory_line);
    if (!tank.begin()) console.println(tank.statusName());
}

void loop()
{
    if (!tank.available()) return;
    if (tank.hasTarget())
        console.println(tank.distanceMm());
    else
        console.println(tank.resultName());
}
