// SPDX-License-Identifier: MIT
// HPS-167S, Modbus RTU on RS485, with factory settings. It works too if the sensor sends by itself, as it may then.
// DI to TX, RO to RX, DE and /RE to pin 2; 10 kOhm from RO to 5 V, from DE to ground. Disconnect RO while uploading.
// It prints by pin 11, to a USB adapter. With Serial1: write Serial1 for Serial, and Serial for console.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial console(10, 11); // RX, TX
FathomBus bus(Serial, 2);
FathomHps167s gate(bus);

void setup()
{
    console.begin(115200);
    bus.begin(fathom_hps167s_factory_line);
    if (!gate.begin()) console.println(gate.statusName());
}

void loop()
{
    if (!gate.available()) return;
    if (gate.hasTarget())
        console.println(gate.distanceMm());
    else
        console.println(gate.resultName());
}
