/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/fathom.h"

int main(int argc, char **argv)
{
    static board_bus_t bus;
    static fathom_a16_controlled_t tank;
    if (!board_open_listening(&bus, &fathom_a16_factory_line, argc, argv)) return 1;
    const fathom_output_t trigger = fathom_output_line_break(&bus.line);
    if (fathom_a16_controlled_init(&tank, &bus.line, &trigger, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = board_read(&bus, fathom_a16_controlled_sensor(&tank), &sample);
        board_print(status, &sample);
    }
}
