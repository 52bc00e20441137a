// SPDX-License-Identifier: MIT
// The example hps167s_rs485 with what it would print in records: kind 1 a distance (65535: none), kind 2 an error
// (its number without the sign). Pin 8 high: its loop comes round every 20 ms. Pin 9 high: Timer0 drops driver-enable.
class records
{
  public:
    void begin(unsigned long) {}
    void print(const __FlashStringHelper *) { kind_ = 2; }
    void println(long value)
    {
        const uint16_t number = kind_ == 2 ? -value : value;
        GPIOR0 = number >> 8;
        GPIOR0 = number & 0xFF;
        GPIOR1 = kind_;
        kind_ = 1;
    }

  private:
    uint8_t kind_ = 1;
};

static records report;
#define PRINT_TO report
#define setup    setup_of_example
#define loop     loop_of_example
#include "hps167s_rs485/hps167s_rs485.ino"
#undef setup
#undef loop

ISR(TIMER0_COMPA_vect) { port.release(); }

void setup()
{
    setup_of_example();
    if (digitalRead(9) == HIGH) {
        OCR0A = 0x80;
        TIMSK0 |= _BV(OCIE0A);
    }
}

void loop()
{
    loop_of_example();
    if (digitalRead(8) == HIGH) delay(20);
}
