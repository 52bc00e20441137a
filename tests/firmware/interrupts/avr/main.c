/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/*
 *     interrupts_avr IMAGES --list         the names of the scenarios
 *     interrupts_avr IMAGES NAME DEPTH     one of them; DEPTH as depth_t has it
 */
static const scenario_t *scenario_of(const char *name)
{
    for (unsigned i = 0; i < scenario_count; i++)
        if (strcmp(scenarios[i].name, name) == 0) return &scenarios[i];
    board_give_up("there is no scenario %s", name);
}

int main(int count, char **words)
{
    setvbuf(stdout, NULL, _IOLBF, 0); /* of each process */
    if (count < 3) board_give_up("usage: interrupts_avr IMAGES (--list | NAME DEPTH)");
    if (strcmp(words[2], "--list") == 0) {
        for (unsigned i = 0; i < scenario_count; i++) printf("%s\n", scenarios[i].name);
        return EXIT_SUCCESS;
    }
    const scenario_t *const scenario = scenario_of(words[2]);
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) board_give_up("no memory");
    board_start_from(words[1], "interrupts");
    board_join_driver('D', 3);
    const board_record_t *const record = board_next_record(100000);
    if (record == NULL || record->kind != CALLS_READY) board_give_up("the image does not begin");
    return enumerate(scenario, count > 3 ? (depth_t)atoi(words[3]) : DEPTH_ALONE) ? EXIT_SUCCESS
                                                                                  : EXIT_FAILURE;
}
