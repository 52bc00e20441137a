/* SPDX-License-Identifier: MIT */
#include "cli/pins_help.h"

void pins_help(FILE *to)
{
    (void)fputs(
        "\nThe modes pwm and switch of an a16, and relay of an a05, are on lines of a GPIO chip of this "
        "board (Linux "
        "5.10 or\n"
        "later), by their numbers on the chip; gpioinfo lists them:\n"
        "  a16:pwm           trigger= is an output, to the sensor's RX; echo= has the pulse of its TX. A "
        "reading each "
        "221 ms\n"
        "  a16:switch        in= is its TX, high when something is nearer than its threshold; near=low if it "
        "was set to "
        "the\n"
        "                    other polarity. near or far, without a distance: the first state and each new "
        "one, and "
        "with\n"
        "                    --interval that again and again\n"
        "  a05:relay         in= is the normally open contact, which goes to ground with bias=up, to 3.3 V "
        "with "
        "bias=down;\n"
        "                    of the normally closed one near=high with bias=up, near=low with bias=down\n"
        "Lines that are not named are left alone, and trigger= alone is driven. A cut wire of a switch or a "
        "relay looks "
        "like\n"
        "one of its states: pull it (bias=) to the harmless one.\n"
        "Pins of most boards take 3.3 V and no more; 5 V or RS232 destroys them. An a16's TX is 3 V when it "
        "is high, and "
        "its\n"
        "RX stands 5 V.\n"
        "How exact a pulse is depends on how soon the kernel stamps an edge: on the load, on the processor's "
        "sleep, and on "
        "the\n"
        "chip's driver (one behind I2C or USB is late by milliseconds); 1 us are 0.17 mm. Measure it on your "
        "board: let a "
        "target\n"
        "stand still, and read --stats=10 prints least, most and mean width, their standard deviation, and "
        "what was "
        "rejected.\n",
        to);
}
