/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "board.h"

/*
 * One transaction of real firmware, and the request of the next: the image of examples/avr/hps167s_rs485.c on the bench
 * of tests/firmware/avr, which asks a simulated HPS-167S. A line of what it prints is BEGIN_US,END_US,WHAT,TEXT, from
 * the first start bit of the request on: `sent` and `came` are bytes on the wire, `driver` is driver-enable (PD2) while
 * it is high.
 */
enum {
    REQUEST = 8,
    RESPONSE = 13,
    FIRST = 4 * (REQUEST + RESPONSE),
    LAST = FIRST + REQUEST + RESPONSE + REQUEST
};

static fathom_sim_line_t line;
static fathom_sim_hps167s_t hps;
static fathom_sim_fixed_t scene = {{3000, 0, 0, 0}};
static double zero_cycle;

static void tell(uint64_t begin_cycle, uint64_t end_cycle, const char *what, const char *text)
{
    printf("%.2f,%.2f,%s,%s\n", ((double)begin_cycle - zero_cycle) / BOARD_CYCLES_PER_US,
           ((double)end_cycle - zero_cycle) / BOARD_CYCLES_PER_US, what, text);
}

static bool is_whole(void *ctx) { return board.bytes_seen > LAST; }

int main(void)
{
    board_start("hps167s_rs485");
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&scene)});
    board_attach(&line, &hps.device, false);
    board_join_line(&line);
    board_join_driver('D', 2);
    if (!board_run(is_whole, NULL, 1000000)) board_give_up("there were no five transactions in a second");
    if (board.cut_bytes != 0 || board.talked_over != 0) board_give_up("the driver was not on in time");
    zero_cycle = (double)board.bytes[FIRST].begin_cycle;
    for (uint32_t i = FIRST; i < LAST; i++) {
        const board_byte_t *const byte = &board.bytes[i];
        char text[4];
        snprintf(text, sizeof text, "%02X", byte->byte);
        tell(byte->begin_cycle, byte->end_cycle, byte->from_here ? "sent" : "came", text);
    }
    const uint64_t last_cycle = board.bytes[LAST - 1].end_cycle;
    for (uint32_t i = 0; i + 1 < board.driver_edges_seen; i++) {
        const board_edge_t *const edge = &board.driver_edges[i];
        if (!edge->high || edge[1].cycle < board.bytes[FIRST].begin_cycle || edge->cycle > last_cycle)
            continue;
        tell(edge->cycle, edge[1].cycle, "driver", "high");
    }
    board_end();
    return 0;
}
