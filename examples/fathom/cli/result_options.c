/* SPDX-License-Identifier: MIT */
#include "cli/result_options.h"

#include <inttypes.h>

#include "cli/command.h"
#include "cli/options.h"

bool result_options(results_config_t *config, uint32_t interval_us, const char *command,
                    const char *const *values)
{
    const origin_t origin = usage_origin(command, 0);
    if (!values_store(result_rows, values, config, command)) return false;
    if (config->gate_mm != 0 && config->median == 0)
        return reject(&origin, "gate has no effect without median.");
    return results_finish(config, interval_us, &origin);
}

void result_options_help(FILE *to)
{
    (void)fputs(
        "  --median N        the median of the last N samples of each probe, 3 to 15, in place of each; "
        "nothing before\n"
        "                    there are N. After 5 s (or three intervals, if longer) without a sample it "
        "begins anew\n"
        "  --gate MM         drops a sample that is farther than that from the median: a spike; the third "
        "one "
        "in a row\n"
        "                    is none, something has moved. How many were dropped is told by --stats\n"
        "  --level KEYS      what is in a tank, from the distance to its surface, for all sensors: "
        "level_mm, level_per_mille\n"
        "                    and volume. mounting=MM from the bottom to the sensor's face, height=MM when it "
        "is full,\n"
        "                    capacity=VOLUME then, in any unit; shape=upright (default), "
        "horizontal-cylinder, or table\n"
        "                    with points=LEVEL:VOLUME/LEVEL:VOLUME.. in place of capacity; offset=MM is "
        "added "
        "to each\n"
        "                    distance\n"
        "  --alarm KEYS      an alarm of each probe, of which only the changes are printed: near<ON/OFF or "
        "far>ON/OFF, in\n"
        "                    mm (quoted, because of the shell; without /OFF it is as ON), then unknown=on or "
        "off, and\n"
        "                    no-response=on or off: is it on where no distance comes? Also hold=MS/MS, so "
        "long it has to\n"
        "                    be nearer or farther before it goes on, and off; unknown-after=MS (default 5 s, "
        "or three\n"
        "                    intervals); no-target=unknown, which is far otherwise. Its first state is told "
        "with the first\n"
        "                    distance that decides it, or after unknown-after\n",
        to);
}
