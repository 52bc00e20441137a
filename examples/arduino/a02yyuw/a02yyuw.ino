// SPDX-License-Identifier: MIT
// A02YYUW (SEN0311): TX of the module to pin 10. Other relatives of the A16 are read with their own model.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

SoftwareSerial sensorPort(10, 11); // RX, TX
FathomStreamBus bus(sensorPort);
FathomA16Auto tank(bus);

void setup()
{
    Serial.begin(115200);
    bus.beginListening(*fathom_model_a02yyuw.line_settings);
    if (!tank.begin(fathom_model_a02yyuw)) Serial.println(tank.statusName());
}

void loop()
{
    if (!tank.available()) return;
    if (tank.hasTarget())
        Serial.println(tank.distanceMm());
    else
        Serial.println(tank.resultName());
}
