// SPDX-License-Identifier: MIT
// The example hps167s with what it would print in records: kind 1 a distance (0: no target), kind 2 the name of an error.
// Pin 8 high: its loop comes round every 20 ms; pin 9 high: every 50 ms.
#include <SoftwareSerial.h>
#include <fathom_arduino.h>

class records
{
  public:
    records(uint8_t, uint8_t) {}
    void begin(unsigned long) {}
    void println(uint16_t distance_mm) { record(distance_mm >> 8, distance_mm & 0xFF); }
    void println(const char *name)
    {
        if (strcmp(name, "NO_TARGET") == 0) {
            record(0, 0);
            return;
        }
        while (*name != '\0') GPIOR0 = *name++;
        GPIOR1 = 2;
    }

  private:
    static void record(uint8_t high, uint8_t low)
    {
        GPIOR0 = high;
        GPIOR0 = low;
        GPIOR1 = 1;
    }
};

#define SoftwareSerial records
#define setup          setup_of_example
#define loop           loop_of_example
#include "hps167s/hps167s.ino"
#undef setup
#undef loop

void setup() { setup_of_example(); }

void loop()
{
    loop_of_example();
    if (digitalRead(8) == HIGH) delay(20);
    if (digitalRead(9) == HIGH) delay(50);
}
