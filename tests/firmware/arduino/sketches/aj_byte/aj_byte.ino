// SPDX-License-Identifier: MIT
// AJ-SR04M that measures when it receives a byte: TX of the module to pin 10, its RX to pin 11.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial sensorPort(10, 11); // RX, TX
FathomStreamBus bus(sensorPort);
FathomA16Controlled tank(bus, 7);

void setup()
{
    Serial.begin(115200);
    bus.beginListening(*fathom_model_aj_sr04m_controlled.line_settings);
    if (!tank.begin(fathom_model_aj_sr04m_controlled)) Serial.println(tank.statusName());
}

void loop()
{
    if (!tank.available()) return;
    if (tank.hasTarget())
        Serial.println(tank.distanceMm());
    else
        Serial.println(tank.resultName());
}
