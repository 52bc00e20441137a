/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/fathom.h"

int main(int argc, char **argv)
{
    static board_bus_t bus;
    static fathom_hps167s_t gate;
    if (!board_open(&bus, &fathom_hps167s_factory_line, argc, argv)) return 1;
    if (fathom_hps167s_init(&gate, &bus.modbus, NULL) != FATHOM_OK) return 1;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = board_read(&bus, fathom_hps167s_sensor(&gate), &sample);
        board_print(status, &sample);
    }
}
