/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FUZZ_H
#define FATHOM_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/*
 * What all targets share. A target is a file fuzz_NAME.c with this function, which libFuzzer calls with input after
 * input, and which replay.c calls without libFuzzer. It keeps nothing from one call to the next.
 */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A sentence of a header that has to hold. One that does not ends the program, which libFuzzer reports as a crash. */
#define PROMISE(holds, sentence) ((holds) ? (void)0 : fuzz_broken(__FILE__, __LINE__, sentence))
void fuzz_broken(const char *file, int line, const char *sentence) __attribute__((noreturn));

/* ---- the input: what has been taken is gone; zeros follow its end ---- */

typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_input_t;

extern fuzz_input_t fuzz_input;

static inline void fuzz_begin(const uint8_t *data, size_t size) { fuzz_input = (fuzz_input_t){data, size}; }
static inline bool fuzz_more(void) { return fuzz_input.left != 0; }

static inline uint8_t fuzz_byte(void)
{
    if (fuzz_input.left == 0) return 0;
    fuzz_input.left--;
    return *fuzz_input.at++;
}

static inline uint16_t fuzz_word(void)
{
    const uint8_t high = fuzz_byte();
    return (uint16_t)(high << 8 | fuzz_byte());
}

/* A copy in memory of exactly its size, so that a byte too many is seen. To be freed. */
void *fuzz_copy(const void *bytes, size_t size);

/* The rest of the input so, but no more than `most` bytes. */
uint8_t *fuzz_rest(size_t most, size_t *size);

/* `size` bytes of FUZZ_GUARD; and: are they still that? */
enum { FUZZ_GUARD = 0xA5 };
void *fuzz_guarded(size_t size);
bool fuzz_is_guard(const void *bytes, size_t size);

/* ---- what the datasheets and the standards define, once more and slowly ---- */

/* CRC-16/MODBUS bit by bit: MODBUS over Serial Line V1.02, 6.2.2. */
uint16_t fuzz_crc(const uint8_t *bytes, size_t size);
void fuzz_seal(uint8_t *frame, size_t size); /* puts it behind `size` bytes, the low byte first */

/* The low byte of the sum: A16 2(3), A05 2(3). */
uint8_t fuzz_sum(const uint8_t *bytes, size_t size);

static inline uint16_t fuzz_word_at(const uint8_t *bytes) { return (uint16_t)(bytes[0] << 8 | bytes[1]); }

#endif
