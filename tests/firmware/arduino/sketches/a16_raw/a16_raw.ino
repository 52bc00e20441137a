// SPDX-License-Identifier: MIT
// The example a16_pwm with the width of each pulse.
#include <fathom_arduino.h>

FathomA16Pwm tank(2, 7);

void setup()
{
    Serial.begin(115200);
    tank.begin();
}

void loop()
{
    if (!tank.available()) return;
    if (!tank.hasTarget()) {
        Serial.println(tank.resultName());
        return;
    }
    Serial.print(tank.distanceMm());
    Serial.print(F(" mm, "));
    Serial.print(tank.sample().raw);
    Serial.println(F(" us"));
}
