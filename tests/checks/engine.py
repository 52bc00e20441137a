#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The library keeps its state in enums and bools that a reader can name: no state is packed into bits, and no cast
hides a comparison.

    engine.py     each line of src and include with one of the patterns below: file, line, the pattern, what to use instead

The patterns are read in the code without comments and strings."""
import re

from common import code_of, files, main, read

FOLDERS = ('src', 'include')

# Sets of units, settings or probes: each bit is a member, and all bits mean the same.
SETS = ('quarantined_units', 'unconfirmed', 'waiting', 'left', 'missing', 'probes')
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
COMPILED = [(re.compile(expression), wrong, instead) for expression, wrong, instead in PATTERNS]


def faults(text):
    """(line, what is wrong, what to use instead), for each pattern."""
    code = code_of(text)
    for expression, wrong, instead in COMPILED:
        for found in expression.finditer(code):
            if expression.groups and found[1] in SETS + FLAGS:
                continue
            yield code.count('\n', 0, found.start()) + 1, wrong, instead


def check(root, only):
    problems = []
    for path in only or files(root, *FOLDERS, ends=('.c', '.h')):
        problems += [f'{path}:{line}: {wrong}; use {instead}' for line, wrong, instead in faults(read(root, path))]
    return problems


if __name__ == '__main__':
    main(check, ('src/engine/line_options.c', None,
                 '\nvoid f(fathom_line_t *line);\nvoid f(fathom_line_t *line)\n{\n    line->echo |= 0x40;\n}\n',
                 'sets a bit of a member'))
