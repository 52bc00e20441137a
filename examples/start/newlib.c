/* SPDX-License-Identifier: MIT */
#include "newlib.h"

#include <stdint.h>

/* What newlib's printf() calls besides _write(), which the machine's print.c has. There are no files. The heap has room
 * for newlib's own three streams and not for a buffer, so each character is one _write(). */
enum { HEAP = 512 };

/* NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): newlib's names */
int _read(int file, char *text, int length); /* NOLINT(readability-non-const-parameter): newlib's type */
int _close(int file);
int _lseek(int file, int offset, int whence);
int _fstat(int file, void *status);
int _isatty(int file);
void *_sbrk(int size);

/* NOLINTNEXTLINE(readability-non-const-parameter): newlib's type */
int _read(int file, char *text, int length) { return (void)file, (void)text, (void)length, -1; }
int _close(int file) { return (void)file, -1; }
int _lseek(int file, int offset, int whence) { return (void)file, (void)offset, (void)whence, -1; }
int _fstat(int file, void *status) { return (void)file, (void)status, -1; }
int _isatty(int file) { return (void)file, 1; }

void *_sbrk(int size)
{
    static uint64_t heap[HEAP / sizeof(uint64_t)] = {0};
    static int used;
    if (size > HEAP - used)
        return (void *)(intptr_t)-1; /* NOLINT(performance-no-int-to-ptr): sbrk() fails like this */
    used += size;
    return (uint8_t *)heap + used - size;
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */
