/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <stdio.h>

#include "fuzz.h"

/*
 * A target without libFuzzer: replay_NAME FILE... gives it each file of found/, bytes in hex with comments behind #,
 * and ends with "N passed, 0 failed". A broken promise ends it before that.
 */
enum { MOST = 65536 };

static size_t read_hex(FILE *from, uint8_t *bytes)
{
    size_t digits = 0;
    int c;
    while ((c = getc(from)) != EOF) {
        if (c == '#')
            while (c != '\n' && c != EOF) c = getc(from);
        if (!isxdigit(c) || digits == 2u * MOST) continue;
        const int digit = isdigit(c) ? c - '0' : tolower(c) - 'a' + 10;
        bytes[digits / 2] = (uint8_t)(digits % 2 == 0 ? digit << 4 : bytes[digits / 2] | digit);
        digits++;
    }
    return digits / 2;
}

int main(int argc, char **argv)
{
    static uint8_t bytes[MOST];
    int passed = 0;
    for (int i = 1; i < argc; i++) {
        FILE *const file = fopen(argv[i], "r");
        if (file == NULL) {
            perror(argv[i]);
            return 1;
        }
        const size_t size = read_hex(file, bytes);
        (void)fclose(file);
        uint8_t *const copy = fuzz_copy(bytes, size);
        (void)LLVMFuzzerTestOneInput(copy, size);
        free(copy);
        passed++;
    }
    (void)printf("%d passed, 0 failed\n", passed);
    return 0;
}
