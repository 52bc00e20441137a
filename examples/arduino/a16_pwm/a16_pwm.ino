// SPDX-License-Identifier: MIT
// A16 with PWM output: TX of the module to pin 2, its RX (the trigger) to pin 7.
#include <fathom_arduino.h>

FathomA16Pwm tank(2, 7);

void setup()
{
    Serial.begin(115200);
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
