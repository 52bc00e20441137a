// SPDX-License-Identifier: MIT
// A16 with switch output: TX of the module to pin 4. A resistor from pin 4 to the supply makes a cut wire read NEAR.
#include <fathom_arduino.h>

FathomA16Switch door(4);

void setup()
{
    Serial.begin(115200);
    if (!door.begin()) Serial.println(door.statusName());
}

void loop()
{
    if (door.available()) Serial.println(door.resultName()); // NEAR, FAR or an error
}
