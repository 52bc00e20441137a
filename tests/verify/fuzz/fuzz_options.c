/* SPDX-License-Identifier: MIT */
#include "tool.h"

#include <ctype.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"
#include "output/words.h"
#include "ports/port.h"

/*
 * What a user writes: whole command lines, a word a line, of every command; and the parsers of numbers, places, ports,
 * settings, levels and alarms by themselves. What is taken is written as text, and that is taken as the same.
 */
enum { WORDS = 40, TEXT = 600, DIGITS = 10, MANY_DIGITS = 40 };

static char text[TEXT];

static void take_text(void)
{
    size_t length = fuzz_input.left < TEXT / 6 ? fuzz_input.left : TEXT / 6;
    memcpy(text, fuzz_input.at, length);
    text[length] = '\0';
}

/* ---- numbers ---- */

/* words.h: "All of `text` is a decimal number", of 10 digits at most. */
static bool is_number(const char *from, const char *end, uint32_t min, uint32_t max, uint32_t *number)
{
    uint64_t sum = 0;
    if (from == end || end - from > 10) return false;
    for (; from != end; from++) {
        if (!isdigit((unsigned char)*from)) return false;
        sum = sum * 10 + (uint64_t)(*from - '0');
    }
    *number = (uint32_t)sum;
    return sum >= min && sum <= max;
}

static void check_numbers(uint8_t how)
{
    const uint32_t min = (how & 1) != 0 ? fuzz_byte() : 0;
    const uint32_t max = (how & 2) != 0 ? fuzz_word() : UINT32_MAX;
    uint32_t is[2] = {77, 77};
    uint32_t should[2];
    take_text();
    const char *const end = text + strlen(text);
    const bool is_taken = number_parse(text, min, max, is);
    PROMISE(is_taken == is_number(text, end, min, max, should), "words.h: number_parse");
    PROMISE(is[0] == (is_taken ? should[0] : 77), "words.h: the number; one that is refused changes nothing");
    const char *const dash = strchr(text, '-');
    const bool is_range = dash == NULL ? is_number(text, end, min, max, should)
                                       : is_number(text, dash, min, max, should) &&
                                             is_number(dash + 1, end, should[0], max, should + 1);
    if (dash == NULL) should[1] = should[0];
    PROMISE(range_parse(text, min, max, is, is + 1) == is_range, "words.h: range_parse");
    if (is_range) PROMISE(is[0] == should[0] && is[1] == should[1], "words.h: the range");
}

/* The same text with every number written with zeros before it. */
static const char *padded(const char *from, size_t to_digits)
{
    static char to[TEXT * MANY_DIGITS];
    size_t length = 0;
    while (*from != '\0') {
        const size_t digits = strspn(from, "0123456789");
        for (size_t i = digits; digits != 0 && i < to_digits; i++) to[length++] = '0';
        memcpy(to + length, from, digits != 0 ? digits : 1);
        length += digits != 0 ? digits : 1;
        from += digits != 0 ? digits : 1;
    }
    to[length] = '\0';
    return to;
}

/* ---- levels and alarms ---- */

/* Stores `of` as the value of --NAME. */
static bool take(const char *name, const char *of, results_config_t *result)
{
    static results_config_t config; /* it points at itself */
    static char copy[TEXT * MANY_DIGITS];
    const option_table_t tables[] = {{result_rows, 0}, {NULL, 0}};
    const origin_t origin = {.command = "read"};
    option_walk_t walk;
    memset(&config, 0, sizeof config);
    (void)snprintf(copy, sizeof copy, "%s", of);
    tool_capture();
    const bool is_taken = option_find(&walk, tables, name) && option_set(walk.row, copy, &config, &origin);
    tool_release();
    PROMISE(is_taken == (tool.err_size == 0) && tool.out_size == 0, "what is wrong is said");
    *result = config;
    return is_taken;
}

static void check_option(const char *option)
{
    static results_config_t first;
    static results_config_t other;
    take_text();
    const bool is_taken = take(option, text, &first);
    if (take(option, padded(text, fuzz_input.left % 2 == 0 ? DIGITS : MANY_DIGITS), &other))
        PROMISE(is_taken && memcmp(&first, &other, sizeof first) == 0,
                "a number with zeros before it is the same");
    if (!is_taken || strcmp(option, "alarm") != 0) return;
    const fathom_alarm_config_t *const is = &first.alarm;
    char after[40] = "";
    if (is->unknown_us != 0) (void)snprintf(after, sizeof after, ",unknown-after=%u", is->unknown_us / 1000);
    (void)snprintf(text, sizeof text, "%s%u/%u,unknown=%s,no-response=%s,hold=%u/%u,no-target=%s%s",
                   is->when == FATHOM_NEAR ? "near<" : "far>", is->on_mm, is->off_mm,
                   is->if_unknown == FATHOM_ALARM_ON ? "on" : "off",
                   is->if_no_response == FATHOM_ALARM_ON ? "on" : "off", is->on_hold_us / 1000,
                   is->off_hold_us / 1000, is->no_target_is_unknown ? "unknown" : "far", after);
    PROMISE(take(option, text, &other) && memcmp(&first, &other, sizeof first) == 0,
            "an alarm that is written out is taken as the same");
}

/* ---- places, TCP, settings ---- */

static void check_tcp(void)
{
    static tcp_address_t first;
    static tcp_address_t again;
    char path[TEXT] = "tcp:";
    take_text();
    (void)snprintf(path + 4, sizeof path - 4, "%s", text);
    PROMISE(port_kind(path) == PORT_GATEWAY, "port_options.h: a path over TCP, right or wrong");
    if (tcp_parse(path, &first) != NULL) return;
    uint32_t port;
    PROMISE(first.host[0] != '\0' && number_parse(first.service, 1, 65535, &port),
            "port_options.h: a host and a port");
    const bool is_in_brackets = strchr(first.host, ':') != NULL || first.host[0] == '[';
    (void)snprintf(path, sizeof path, is_in_brackets ? "tcp:[%s]:%s" : "tcp:%s:%s", first.host,
                   first.service);
    PROMISE(tcp_parse(path, &again) == NULL && strcmp(first.host, again.host) == 0 &&
                strcmp(first.service, again.service) == 0,
            "port_options.h: what is written out is taken as the same");
}

static bool take_place(sensor_word_t *place, char *word)
{
    tool_capture();
    const origin_t origin = {.command = "read"};
    const bool is_taken = sensor_word_parse(place, word, &origin);
    tool_release();
    PROMISE(is_taken == (tool.err_size == 0), "sensor_word.h: false after a usage error");
    return is_taken;
}

static void check_place(void)
{
    static sensor_word_t first;
    static sensor_word_t again;
    char word[TEXT];
    take_text();
    if (!take_place(&first, text)) return;
    const sensor_word_t *const sensor = &first;
    PROMISE(sensor->model != NULL, "sensor_word.h: a sensor has a model");
    (void)snprintf(word, sizeof word, "%s%s%s%s%s%s%s%s%s", first.name, first.name[0] != '\0' ? "=" : "",
                   sensor->model->name, sensor->address != NULL ? ":" : "",
                   sensor->address != NULL ? sensor->address : "", sensor->mode != NULL ? ":" : "",
                   sensor->mode != NULL ? sensor->mode : "", first.port != NULL ? "@" : "",
                   first.port != NULL ? first.port : "");
    PROMISE(take_place(&again, word), "sensor_word.h: what is written out is taken");
    PROMISE(strcmp(first.name, again.name) == 0 && sensor->model == again.model &&
                (first.port == NULL) == (again.port == NULL) &&
                (first.port == NULL || strcmp(first.port, again.port) == 0),
            "sensor_word.h: what is written out is taken as the same");
}

static void check_setting(uint8_t how)
{
    const setting_t *setting = models[how % model_count].settings;
    char printed[SETTING_TEXT];
    int32_t value = 0;
    int32_t again = 0;
    for (uint8_t skipped = fuzz_byte() % 32; skipped != 0 && setting[1].name != NULL; skipped--) setting++;
    take_text();
    if (setting->effect == NULL || !setting_value(setting, text, &value)) return;
    PROMISE(setting->words != NULL || (value >= setting->least && value <= setting->most) ||
                (value == 0 && setting->has_zero),
            "setting.h: from least to most");
    setting_print_value(setting, value, printed);
    PROMISE(setting_value(setting, printed, &again) && again == value,
            "session.h: what is printed is the same");
}

/* ---- command lines ---- */

static void run(char *line, size_t length)
{
    static char program[] = "fathom";
    char *argv[WORDS + 2] = {program};
    int argc = 1;
    char *word = line;
    char *const end = line + length;
    while (word < end && argc <= WORDS) {
        char *const last = memchr(word, '\n', (size_t)(end - word));
        argv[argc++] = word;
        if (last == NULL) break;
        *last = '\0';
        word = last + 1;
    }
    argv[argc] = NULL;
    tool_run(argc, argv);
}

static void check_command(uint8_t how)
{
    static const uint8_t file[] = "sensor = hps167s\naddress = 7\nwarm-up = 5\n";
    static char line[TEXT];
    const size_t length = fuzz_input.left < TEXT - 1 ? fuzz_input.left : TEXT - 1;
    memcpy(line, fuzz_input.at, length);
    line[length] = '\0';
    tool_file((how & 64) != 0 ? file : NULL, sizeof file - 1);
    run(line, length);
    PROMISE(tool.status >= 0 && tool.status <= 2,
            "command.h: the exit status; 3 is an alarm, and nothing was read");
    if (tool.status == 2) {
        PROMISE(tool.opens == 0, "command.h: wrong usage: no port was opened");
        PROMISE(tool.out_size == 0 && tool.err_size != 0,
                "command.h: wrong usage is said on stderr, and nothing else");
    }
    if (tool.status != 0) PROMISE(tool.err_size != 0 || tool.out_size != 0, "what has failed is said");
    if (tool.opens != 0) PROMISE(tool.status == 1 || tool.err_size != 0, "a port that is not there is told");
    if (tool.err_size != 0) PROMISE(strncmp(tool.err, "fathom", 6) == 0 || tool.status == 1, "who says it");
    if ((how & 128) == 0) return;
    /* host.h: none of them keeps anything */
    const tool_t first = tool;
    char *const out = fuzz_copy(tool.out, tool.out_size);
    const size_t size = tool.out_size;
    memcpy(line, fuzz_input.at, length);
    line[length] = '\0';
    run(line, length);
    PROMISE(tool.status == first.status && tool.opens == first.opens && tool.out_size == size &&
                memcmp(out, tool.out, size) == 0,
            "host.h: a command runs after another as if it were the first");
    free(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint8_t how = fuzz_byte();
    switch (how % 16) {
    case 0:
        check_numbers(how >> 4);
        break;
    case 1:
        check_tcp();
        break;
    case 2:
        check_setting(how >> 4);
        break;
    case 3:
        check_option("alarm");
        break;
    case 4:
        check_option("level");
        break;
    case 5:
        check_place();
        break;
    default:
        check_command(how);
    }
    return 0;
}
