/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/fathom.h"

int main(int argc, char **argv)
{
    static board_bus_t bus;
    static fathom_a05_auto_t bumper;
    if (!board_open_listening(&bus, &fathom_a05_factory_line, argc, argv)) return 1;
    if (fathom_a05_auto_init(&bumper, &bus.line, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = board_read(&bus, fathom_a05_auto_sensor(&bumper), &sample);
        board_print(status, &sample);
    }
}
