// SPDX-License-Identifier: MIT
// HC-SR04: Echo to pin 2, Trig to pin 7. Each module of src/models/README.md with pulses is read so.
#include <fathom_arduino.h>

FathomA16Pwm tank(2, 7);

void setup()
{
    Serial.begin(115200);
    if (!tank.begin(fathom_model_hc_sr04)) Serial.println(tank.statusName());
}

void loop()
{
    if (!tank.available()) return;
    if (tank.hasTarget())
        Serial.println(tank.distanceMm());
    else
        Serial.println(tank.resultName());
}
