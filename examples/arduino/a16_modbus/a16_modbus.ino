// SPDX-License-Identifier: MIT
// A16, Modbus RTU on RS485. Transceiver: DI to TX, RO to RX, DE and /RE to pin 2.
// An Uno has one UART, so it prints by pin 11, to a USB adapter. If a board has Serial1, write Serial1 in place of
// Serial, and Serial in place of console.
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
