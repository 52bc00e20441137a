/* SPDX-License-Identifier: MIT */
#include "tool.h"

#include "cli/config.h"

/* The configuration of `fathom publish` (config.h), with anything in it. What is taken can be explained, and has no two sensors
 * with the same topics; what is refused is said, in a line that drives no terminal. */
static void check_text(const char *text, size_t size, const char *sentence)
{
    for (size_t i = 0; i != size; i++)
        PROMISE(text[i] == '\n' || (text[i] & 0x80) != 0 || (text[i] >= ' ' && text[i] <= '~'), sentence);
}

static void check_names(const site_t *site)
{
    PROMISE(site->sensor_count >= 1 && site->sensor_count <= MAX_SENSORS, "config.h: there are sensors");
    for (size_t i = 0; i != site->sensor_count; i++)
        for (size_t other = 0; other != i; other++)
            PROMISE(strcmp(site->sensors[i]->name, site->sensors[other]->name) != 0,
                    "config.h: each has a name of its own");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static publish_settings_t settings;
    site_t site = {.lines = NULL};
    size_t length;
    fuzz_begin(data, size);
    uint8_t *const bytes = fuzz_rest(4000, &length);
    tool_file(bytes, length);
    tool_capture();
    const bool is_good = config_load(&settings, &site, "publish", "site.yaml");
    tool_release();
    if (is_good) {
        char *words[] = {"fathom", "publish", "--check", "site.yaml", NULL};
        PROMISE(tool.err_size == 0 && tool.out_size == 0, "config.h: prints nothing about a good file");
        check_names(&site);
        tool_run(4, words);
        PROMISE(tool.status == 0 && tool.err_size == 0 && tool.out_size != 0,
                "publish --check prints a table");
        check_text(tool.out, tool.out_size, "the table drives no terminal");
        site_free(&site);
    } else {
        PROMISE(tool.err_size != 0 && tool.out_size == 0 && tool.err[tool.err_size - 1] == '\n' &&
                    strncmp(tool.err, "fathom publish: ", 16) == 0,
                "config.h: what is wrong is said");
        check_text(tool.err, tool.err_size, "nothing that drives a terminal is said");
    }
    free(bytes);
    return 0;
}
