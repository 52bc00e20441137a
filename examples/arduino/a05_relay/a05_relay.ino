// SPDX-License-Identifier: MIT
// A05 with relay output: NO to pin 4, COM to ground. A cut wire reads FAR.
#include <fathom_arduino.h>

FathomA05Relay door(4);

void setup()
{
    Serial.begin(115200);
    if (!door.begin()) Serial.println(door.statusName());
}

void loop()
{
    if (door.available()) Serial.println(door.resultName()); // NEAR, FAR or an error
}
