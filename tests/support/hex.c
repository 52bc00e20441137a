/* SPDX-License-Identifier: MIT */
#include "hex.h"

#include <stdlib.h>

uint8_t hex_parse(const char *hex, uint8_t *bytes)
{
    uint8_t length = 0;
    for (; *hex != 0; hex += hex[2] != 0 ? 3 : 2) bytes[length++] = (uint8_t)strtol(hex, NULL, 16);
    return length;
}
