/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "semihosting.h"

static bool has_failed;

void check(bool is_right, const char *what)
{
    semihosting_write(is_right ? "ok " : "FAILED ");
    semihosting_write(what);
    semihosting_write("\n");
    if (!is_right) has_failed = true;
}

static void write_hex(uint32_t value)
{
    char text[] = " 00000000";
    for (unsigned i = 8; i != 0; i--, value >>= 4) text[i] = "0123456789ABCDEF"[value & 15];
    semihosting_write(text);
}

void check_within(uint32_t value, uint32_t least, uint32_t most, const char *what)
{
    const bool is_right = value >= least && value <= most;
    check(is_right, what);
    if (is_right) return;
    write_hex(value);
    write_hex(least);
    write_hex(most);
    semihosting_write("\n");
}

int check_result(void) { return has_failed ? 1 : 0; }
