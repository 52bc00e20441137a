/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/fathom.h"

int main(int argc, char **argv)
{
    static board_pins_t pins;
    static fathom_a16_switch_t tank;
    if (!board_open_contact(&pins, argc, argv)) return 1;
    if (fathom_a16_switch_init(&tank, &pins.contact, &pins.clock, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = board_read_pins(&pins, fathom_a16_switch_sensor(&tank), &sample);
        board_print(status, &sample);
    }
}
