/* SPDX-License-Identifier: MIT */
#include "mqtt/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_add(char *text, size_t capacity, const char *format, ...)
{
    const size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text + length, capacity - length, format, arguments);
    va_end(arguments);
}
