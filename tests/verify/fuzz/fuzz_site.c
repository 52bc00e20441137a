/* SPDX-License-Identifier: MIT */
#include "tool.h"

#include "cli/config.h"
#include "commands/publish/explain.h"

/* The configuration of `fathom publish` (config.h), with anything in it. What is taken can be explained, and has no two sensors
 * with the same topics; what is refused is said, in a line that drives no terminal. */
static void check_text(const char *text, size_t size, const char *sentence)
{
    for (size_t i = 0; i != size; i++)
        PROMISE(text[i] == '\n' || (text[i] & 0x80) != 0 || (text[i] >= ' ' && text[i] <= '~'), sentence);
}

static void check_names(const config_t *config)
{
    const sensor_options_t *const sensors = &config->sensors;
    PROMISE(sensors->station_count >= 1 && sensors->station_count <= MAX_STATIONS,
            "config.h: there are sensors");
    for (size_t i = 0; i != sensors->station_count; i++)
        for (size_t other = 0; other != i; other++)
            PROMISE(strcmp(sensors->stations[i]->name, sensors->stations[other]->name) != 0,
                    "config.h: each has a name of its own");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static config_t config;
    static config_results_t results;
    size_t length;
    fuzz_begin(data, size);
    uint8_t *const bytes = fuzz_rest(4000, &length);
    tool_file(bytes, length);
    tool_capture();
    config.sensors.beside = NULL;
    const bool is_good = config_load(&config, results, "publish", "site.yaml");
    if (is_good) explain(&config, results, stdout);
    tool_release();
    if (is_good) {
        PROMISE(tool.err_size == 0 && tool.out_size != 0, "explain.h: in words");
        check_names(&config);
        check_text(tool.out, tool.out_size, "nothing that drives a terminal is explained");
        config_free(&config);
    } else {
        PROMISE(tool.err_size != 0 && tool.out_size == 0 && tool.err[tool.err_size - 1] == '\n' &&
                    strncmp(tool.err, "fathom publish: ", 16) == 0,
                "config.h: what is wrong is said");
        check_text(tool.err, tool.err_size, "nothing that drives a terminal is said");
    }
    free(bytes);
    return 0;
}
