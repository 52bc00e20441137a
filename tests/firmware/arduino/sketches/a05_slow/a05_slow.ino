// SPDX-License-Identifier: MIT
// The example a05_auto in a loop that comes round every 20 ms.
#define loop loop_of_example
#include "a05_auto/a05_auto.ino"
#undef loop

void loop()
{
    loop_of_example();
    delay(20);
}
