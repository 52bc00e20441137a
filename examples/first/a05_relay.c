/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/fathom.h"

int main(int argc, char **argv)
{
    static board_pins_t pins;
    static fathom_a05_relay_t bumper;
    if (!board_open_contact(&pins, argc, argv)) return 1;
    if (fathom_a05_relay_init(&bumper, &pins.contact, &pins.clock, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = board_read_pins(&pins, fathom_a05_relay_sensor(&bumper), &sample);
        board_print(status, &sample);
    }
}
