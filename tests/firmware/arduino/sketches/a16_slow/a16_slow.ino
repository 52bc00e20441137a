// SPDX-License-Identifier: MIT
// The example a16_pwm in a loop that comes round every 20 ms.
#define loop loop_of_example
#include "a16_pwm/a16_pwm.ino"
#undef loop

void loop()
{
    loop_of_example();
    delay(20);
}
