# SPDX-License-Identifier: MIT
"""The one rule by which a kept figure fails: it is clearly above the figure of the last release.

A figure fails if it is above the kept one by more than 1 % and by more than a step that depends on its unit: 32 bytes,
32 cycles or 32 instructions. So a figure that moved by chance, because a neighbour was aligned differently, refuses no
work. A figure that moved within the limit prints one line, and a smaller figure never fails.

The tables of figures in the pages are those of the last release too. Only --update writes their values, so the tests
compare the names of rows and columns."""
import re

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
