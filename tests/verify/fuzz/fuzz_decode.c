/* SPDX-License-Identifier: MIT */
#include "tool.h"

/*
 * `fathom decode`: any bytes, as they are or as text. What is printed has each byte once and in order, with checksums
 * that this program works out again; the exit status is what the help says.
 */
enum { WORDS = 8 };

static char words[WORDS][32];
static char *argv[WORDS + 1];
static int argc;

static void word(const char *text)
{
    (void)snprintf(words[argc], sizeof words[argc], "%s", text);
    argv[argc] = words[argc];
    argv[++argc] = NULL;
}

/* What stands behind "name":, NULL: nothing. */
static const char *member(const char *line, const char *name)
{
    char key[24];
    (void)snprintf(key, sizeof key, "\"%s\":", name);
    const char *const found = strstr(line, key);
    return found != NULL ? found + strlen(key) : NULL;
}

static unsigned digit(char c) { return (unsigned)(c <= '9' ? c - '0' : c - 'A' + 10); }

/* Of "0A 1B": as many bytes as there are. */
static size_t hex_of(const char *text, uint8_t *bytes, size_t most)
{
    size_t count = 0;
    for (text++; *text != '"' && count != most; text += text[2] == ' ' ? 3 : 2)
        bytes[count++] = (uint8_t)(digit(text[0]) << 4 | digit(text[1]));
    return count;
}

static bool check_frame(const char *line, const uint8_t *frame, size_t length)
{
    const char *const protocol = member(line, "protocol");
    PROMISE(protocol != NULL, "an object has a protocol");
    if (strncmp(protocol, "null", 4) == 0) return false;
    uint8_t expected[2];
    uint8_t found[2];
    const char *const checksum = member(line, "checksum");
    PROMISE(checksum != NULL && length >= 4, "a frame has a checksum");
    const size_t size = strncmp(protocol, "\"modbus\"", 8) == 0 ? 2 : 1;
    expected[0] = fuzz_sum(frame, length - 1);
    if (size == 2) {
        const uint16_t crc = fuzz_crc(frame, length - 2);
        expected[0] = (uint8_t)crc;
        expected[1] = (uint8_t)(crc >> 8);
    }
    const bool is_right = memcmp(expected, frame + length - size, size) == 0;
    PROMISE((strncmp(checksum, "{\"right\":true", 13) == 0) == is_right, "whether its checksum is right");
    PROMISE(hex_of(member(checksum, "expected"), found, 2) == size && memcmp(found, expected, size) == 0,
            "the checksum that it should have");
    PROMISE(hex_of(member(checksum, "found"), found, 2) == size &&
                memcmp(found, frame + length - size, size) == 0,
            "the checksum that it has");
    return is_right;
}

/* Every byte is in one object, in order. Returns whether all are parts of good frames. */
static bool check_json(const uint8_t *bytes, size_t count)
{
    static uint8_t printed[1024];
    bool is_good = true;
    size_t at = 0;
    for (char *line = tool.out, *end; *line != '\0'; line = end + 1) {
        size_t offset = 0;
        size_t length = 0;
        int depth = 0;
        end = strchr(line, '\n');
        PROMISE(end != NULL && line[0] == '{' && end[-1] == '}', "an object a line");
        *end = '\0';
        bool is_in_text = false;
        for (const char *c = line; *c != '\0'; c++) {
            PROMISE(*c >= ' ' && *c <= '~', "nothing in it needs to be escaped");
            if (*c == '"') is_in_text = !is_in_text;
            if (!is_in_text && (*c == '{' || *c == '[')) depth++;
            if (!is_in_text && (*c == '}' || *c == ']')) depth--;
        }
        PROMISE(depth == 0 && !is_in_text, "an object is closed");
        PROMISE(sscanf(line, "{\"offset\":%zu,\"length\":%zu", &offset, &length) == 2, "offset and length");
        PROMISE(offset == at && length >= 1 && at + length <= count, "each byte is explained once, in order");
        PROMISE(hex_of(member(line, "bytes"), printed, sizeof printed) == length &&
                    memcmp(printed, bytes + at, length) == 0,
                "the bytes that were given");
        is_good = check_frame(line, bytes + at, length) && is_good;
        at += length;
    }
    PROMISE(at == count, "no byte is left out");
    return is_good;
}

static void check_text(void)
{
    for (const char *c = tool.out; *c != '\0'; c++)
        PROMISE((*c >= ' ' && *c <= '~') || *c == '\n', "people get printable text");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const protocols[] = {"auto", "modbus", "dyp", "stream"};
    static const char *const sensors[] = {"a16", "a05", "hps167s"};
    fuzz_begin(data, size);
    const uint8_t how = fuzz_byte();
    const uint8_t which = fuzz_byte();
    const bool is_raw = (how & 1) == 0;
    const bool is_json = (how & 2) == 0;
    argc = 0;
    word("fathom");
    word("decode");
    if (is_json) word("--format=json");
    if (is_raw) word("--raw");
    if ((how & 4) != 0)
        (void)snprintf(words[argc], sizeof words[0], "--protocol=%s", protocols[which % 4]),
            argv[argc] = words[argc], argc++;
    if ((how & 8) != 0)
        (void)snprintf(words[argc], sizeof words[0], "--sensor=%s", sensors[which / 4 % 3]),
            argv[argc] = words[argc], argc++;
    argv[argc] = NULL;
    size_t count;
    uint8_t *const bytes = fuzz_rest(1000, &count);
    tool_file(bytes, count);
    tool_run(argc, argv);
    PROMISE(tool.status >= 0 && tool.status <= 2, "0, 1 or 2");
    if (tool.status == 2) {
        PROMISE(tool.out_size == 0 && tool.err_size != 0,
                "wrong usage, or no hex, is said, and nothing is explained");
        PROMISE(!is_raw || (how & 12) == 12, "bytes that are taken as they are are no wrong usage");
    } else if (is_raw && count != 0 && is_json) {
        PROMISE(tool.err_size == 0, "nothing is wrong with any bytes");
        PROMISE(check_json(bytes, count) == (tool.status == 0), "0 when every byte is part of a good frame");
    } else if (!is_json) {
        check_text();
    }
    free(bytes);
    return 0;
}
