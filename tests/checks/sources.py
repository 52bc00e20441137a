#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the text of src/ and include/ may not contain: no heap, no stdio, no floating point, no #if but
include guards and __cplusplus, no compiler extensions. What only the compiler sees is in objects.py."""
import os
import re

from common import code_of, files, main, read

BANNED = [
    (r'\b(malloc|calloc|realloc|free|aligned_alloc|strdup)\s*\(', 'heap'),
    (r'\b(alloca|setjmp|longjmp|abort|exit|assert)\b', 'banned function'),
    (r'\b(\w*printf|\w*scanf|puts|putchar|fputs|fwrite|fopen|FILE)\b', 'stdio'),
    (r'\b(float|double|_Complex)\b', 'floating point'),
    (r'(?<![\w.])(\d+\.\d*|\.\d+)([eE][+-]?\d+)?[fFlL]?(?!\w)', 'floating point'),
    (r'(?<![\w.])\d+[eE][+-]?\d+(?!\w)', 'floating point'),
    (r'\bgoto\b', 'goto'),
    (r'\b(_Thread_local|_Atomic|_Generic|__attribute__|__asm__|asm|__builtin_\w+|typeof)\b', 'not C99'),
    (r'^\s*#\s*pragma\b', 'pragma'),
    (r'\b_Pragma\b', 'pragma'),
]
DIRECTIVE = re.compile(r'^\s*#\s*(if|ifdef|ifndef|elif|else|error|undef)\b\s*(.*?)\s*$')


def directives(path, lines):
    guard = None
    if path.endswith('.h'):
        guard = 'FATHOM_' + os.path.basename(path)[:-2].upper() + '_H'
        first = [line.split() for line in lines if line.strip()][:2]
        if first != [['#ifndef', guard], ['#define', guard]]:
            yield f'{path}:1: no include guard {guard}'
    for number, line in enumerate(lines, 1):
        found = DIRECTIVE.match(line)
        if found is None:
            continue
        if (found[1], found[2]) not in (('ifndef', guard), ('ifdef', '__cplusplus'),
                                        ('ifdef', 'FATHOM_ASSERT'), ('ifdef', 'FATHOM_HAS_ASSERT'), ('ifndef', 'FATHOM_ASSERT')):
            yield f'{path}:{number}: platform #if: {line.strip()}'


def check(root, only):
    problems = []
    for path in files(root, 'src', 'include'):
        if only and path not in only:
            continue
        text = read(root, path)
        if not text.startswith('/* SPDX-License-Identifier: MIT */\n'):
            problems.append(f'{path}:1: the SPDX line is missing')
        lines = code_of(text).split('\n')
        for number, line in enumerate(lines, 1):
            for pattern, what in BANNED:
                if re.search(pattern, line):
                    problems.append(f'{path}:{number}: {what}: {line.strip()}')
        problems += directives(path, lines)
    return problems


FAULT = ('src/engine/line.c', None, 'void *f(void) { return malloc(3); }\n', 'heap')

if __name__ == '__main__':
    main(check, FAULT)
