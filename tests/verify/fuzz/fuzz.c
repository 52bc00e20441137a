/* SPDX-License-Identifier: MIT */
#include "fuzz.h"

#include <stdio.h>

fuzz_input_t fuzz_input;

void fuzz_broken(const char *file, int line, const char *sentence)
{
    (void)fprintf(stderr, "%s:%d: broken promise: %s\n", file, line, sentence);
    abort();
}

void *fuzz_copy(const void *bytes, size_t size)
{
    void *const copy = malloc(size);
    if (copy == NULL) abort();
    if (size != 0) memcpy(copy, bytes, size);
    return copy;
}

uint8_t *fuzz_rest(size_t most, size_t *size)
{
    *size = fuzz_input.left < most ? fuzz_input.left : most;
    return fuzz_copy(fuzz_input.at, *size);
}

void *fuzz_guarded(size_t size)
{
    void *const memory = malloc(size);
    if (memory == NULL) abort();
    memset(memory, FUZZ_GUARD, size);
    return memory;
}

bool fuzz_is_guard(const void *bytes, size_t size)
{
    const uint8_t *byte = bytes;
    while (size != 0 && *byte == FUZZ_GUARD) byte++, size--;
    return size == 0;
}

uint16_t fuzz_crc(const uint8_t *bytes, size_t size)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i != size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit != 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    return crc;
}

void fuzz_seal(uint8_t *frame, size_t size)
{
    const uint16_t crc = fuzz_crc(frame, size);
    frame[size] = (uint8_t)crc;
    frame[size + 1] = (uint8_t)(crc >> 8);
}

uint8_t fuzz_sum(const uint8_t *bytes, size_t size)
{
    uint8_t sum = 0;
    for (size_t i = 0; i != size; i++) sum = (uint8_t)(sum + bytes[i]);
    return sum;
}
