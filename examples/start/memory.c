/* SPDX-License-Identifier: MIT */
/* What a compiler may call where there is no C library. Bytes are volatile so that it makes no call to itself of it. */
#include <stddef.h>

void *memcpy(void *to, const void *from, size_t count);
void *memset(void *to, int value, size_t count);

void *memcpy(void *to, const void *from, size_t count)
{
    volatile unsigned char *at = to;
    for (const unsigned char *byte = from; count != 0; count--) *at++ = *byte++;
    return to;
}

void *memset(void *to, int value, size_t count)
{
    for (volatile unsigned char *at = to; count != 0; count--) *at++ = (unsigned char)value;
    return to;
}
