#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The one rule by which a kept figure fails: it is clearly above the figure of the last release.

A figure fails if it is above the kept one by more than 1 % and by more than a step that depends on its unit: 32 bytes,
32 cycles or 32 instructions. So a figure that moved by chance, because a neighbour was aligned differently, refuses no
work. A figure that moved within the limit prints one line, and a smaller figure never fails.

The tables of figures in the pages are those of the last release too. Only --update writes their values, so the tests
compare the names of rows and columns.

    bounds.py    checks the rule with figures calculated by hand"""
import re
import sys

PERCENT = 1
# The smallest step that counts. 32 cycles at 16 MHz are 2 us, and 500 polls a second make that 0.1 % of the processor.
STEPS = {'B': 32, 'bytes': 32, 'cycles': 32, 'instr.': 32, 'us': 2, '%': 0.1}


def is_over(now, kept, unit='B', percent=PERCENT):
    """Returns True if `now` is above `kept` by more than `percent` and by more than the unit's step."""
    # Figures have at most five decimals; the division of floating-point numbers must not decide.
    return round(now - kept - max(kept * percent / 100, STEPS.get(unit, 0)), 6) > 0


def judge(name, now, kept, unit='B', percent=PERCENT):
    """Returns True if the figure fails. Prints a line if it moved, or if there is no figure of a release."""
    now, kept = float(now), None if kept is None else float(kept)
    if now == kept:
        return False
    fails = kept is not None and is_over(now, kept, unit, percent)
    was = 'has no figure of a release' if kept is None else f'was {kept:g} at the last release'
    print(f'{"OVER" if fails else "new" if kept is None else "moved"}: {name}: {now:g} {unit}, {was}')
    return fails


def names_of(table):
    """Returns the cells of a table of Markdown without its values, which begin with a digit or are a dash."""
    return [[cell.strip() for cell in line.split('|') if not re.match(r' *(\d|– *$)', cell)]
            for line in table.splitlines()]


TABLE = '| | flash | what |\n|---|---|---|\n| job | 3754 B, over 2750 | a queue |\n| peer | – | a codec |\n'

ROWS = [  # now, kept, unit, whether it fails
    (1000, 1000, 'B', False),
    (1032, 1000, 'B', False),       # 32 bytes are more than 1 %, which is 10
    (1033, 1000, 'B', True),
    (10100, 10000, 'B', False),     # 1 % is 100, more than 32
    (10101, 10000, 'B', True),
    (10, 10000, 'B', False),        # a smaller figure never fails
    (90, 58, 'cycles', False),
    (91, 58, 'cycles', True),
    (6.49, 6.39, '%', False),
    (6.50, 6.39, '%', True),
    (5092, 5042, 'ms', False),      # 1 % is 50.42
    (5093, 5042, 'ms', True),
]


def main():
    wrong = [row for row in ROWS if is_over(*row[:3]) != row[3]]
    messages = [f'is_over{row[:3]} is not {row[3]}' for row in wrong]
    if names_of(TABLE) != names_of(TABLE.replace('3754 B, over 2750', '2700 B').replace('–', '12')):
        messages.append('a table with other values has other names')
    if names_of(TABLE) == names_of(TABLE.replace('job', 'jobs')):
        messages.append('a table with another row has the same names')
    print(*messages, f'{len(ROWS) + 2 - len(messages)} passed, {len(messages)} failed', sep='\n')
    return 1 if messages else 0


if __name__ == '__main__':
    sys.exit(main())
