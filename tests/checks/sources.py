#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the text of src/ and include/ may not contain: no heap, no stdio, no floating point, no #if but
include guards and __cplusplus, no compiler extensions, no state packed into bits, no cast that hides a comparison.
What only the compiler sees is in objects.py."""
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

# Sets of units, settings, probes or registers: each bit is a member, and all bits mean the same.
SETS = ('quarantined_units', 'unconfirmed', 'waiting', 'left', 'missing', 'probes', 'registers')
# What a port reports about bytes (hal.h) is a word of flags.
FLAGS = ('flags',)

MEMBER = r'(?:\w+(?:->|\.))+(\w+)'
PATTERNS = [  # pattern; the group that names the member, if any; what is wrong; what to use instead
    (rf'{MEMBER}\s*\|=', 'sets a bit of a member', 'a bool for each fact'),
    (rf'{MEMBER}\s*&=', 'clears bits of a member', 'a bool for each fact'),
    (rf'{MEMBER}\s*=(?!=)\s*[^;]*(?<!\|)\|(?!\|)[^;]*;', 'stores combined bits in a member', 'a bool for each fact'),
    (rf'{MEMBER}\s*&\s*(?:\([^()]*\)\s*)?~?[A-Za-z0-9]', 'reads bits of a member', 'an enum or a bool'),
    (r'&\s*\(u?int(?:8|16|32)_t\)\s*~', 'clears bits by a mask', 'a bool for each fact'),
    (r'(?<!- )\b0x1(?:00|0000)u?\b', 'encodes a second value above a byte or a word', 'a struct with both values'),
    (r'\(u?int(?:8|16)_t\)\s*\([^()]*-[^()]*\)\s*(?:<|>|<=|>=)(?![<>])', 'compares a wrapped difference',
     'a predicate with a name'),
    (r'\breturn\s+(?:\([a-z0-9_]+\)\s*)?-\s*\w*(?:count|length)\w*\s*;', 'returns a negative count',
     'an enum or a struct'),
]


def packed(path, code):
    """State stands in enums and bools that a reader can name."""
    for expression, wrong, instead in PATTERNS:
        for found in re.finditer(expression, code):
            if not found.groups() or found[1] not in SETS + FLAGS:
                line = code.count('\n', 0, found.start()) + 1
                yield f'{path}:{line}: {wrong}; use {instead}'


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


def check(root):
    problems = []
    for path in files(root, 'src', 'include'):
        text = read(root, path)
        if not text.startswith('/* SPDX-License-Identifier: MIT */\n'):
            problems.append(f'{path}:1: the SPDX line is missing')
        code = code_of(text)
        problems += packed(path, code)
        lines = code.split('\n')
        for number, line in enumerate(lines, 1):
            for pattern, what in BANNED:
                if re.search(pattern, line):
                    problems.append(f'{path}:{number}: {what}: {line.strip()}')
        problems += directives(path, lines)
    return problems


if __name__ == '__main__':
    main(check)
