/* SPDX-License-Identifier: MIT */
#include "cli/result_options.h"

#include <inttypes.h>

#include "cli/command.h"
#include "cli/options.h"

static bool take_median(results_config_t *config, const char *command, const char *median, const char *gate)
{
    uint32_t count = 0;
    uint32_t gate_mm = 0;
    if (!option_number(command, "median", median, FATHOM_MEDIAN_MIN_COUNT, FATHOM_MEDIAN_MAX_COUNT, &count) ||
        !option_number(command, "gate", gate, 1, UINT16_MAX, &gate_mm))
        return false;
    if (gate != NULL && median == NULL) {
        (void)usage_error(command, "--gate is the median's: it takes --median too, such as --median 5");
        return false;
    }
    config->median = (uint8_t)count;
    config->gate_mm = (uint16_t)gate_mm;
    return true;
}

/* A median or an alarm that does not outlast the interval would never know anything. */
static bool check_interval(const char *command, const char *what, uint32_t unknown_us, uint32_t interval_us)
{
    if (unknown_us > interval_us) return true;
    (void)usage_error(command,
                      "%s: after %" PRIu32
                      " ms without a reading nothing is known, and --interval is %" PRIu32
                      " ms: it has to be less",
                      what, unknown_us / 1000u, interval_us / 1000u);
    return false;
}

bool result_options(results_config_t *config, uint32_t interval_us, const char *command,
                    const char *const *values)
{
    enum { INTERVALS = 3 };
    const uint64_t intervals_us = (uint64_t)INTERVALS * interval_us;
    const uint32_t most_us = MAX_UNKNOWN_MS * 1000u;
    config->unknown_us = intervals_us < most_us ? (uint32_t)intervals_us : most_us;
    if (config->unknown_us < FATHOM_MEDIAN_DEFAULT_UNKNOWN_US)
        config->unknown_us = FATHOM_MEDIAN_DEFAULT_UNKNOWN_US;
    if (!take_median(config, command, values[OPTION_MEDIAN], values[OPTION_GATE]) ||
        (values[OPTION_LEVEL] != NULL && !level_option(config, command, values[OPTION_LEVEL])) ||
        (values[OPTION_ALARM] != NULL && !alarm_option(config, command, values[OPTION_ALARM])))
        return false;
    if (config->alarm.unknown_us == 0) config->alarm.unknown_us = config->unknown_us;
    return (config->median == 0 || check_interval(command, "--median", config->unknown_us, interval_us)) &&
           (!config->has_alarm || check_interval(command, "--alarm", config->alarm.unknown_us, interval_us));
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
