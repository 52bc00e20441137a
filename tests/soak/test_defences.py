#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Switches off one defence of the library at a time and sees that the soak turns bad without it.

A defence that is no option is switched off by rows of tests/mutation; tests/CMakeLists.txt builds the soak's
program once more for each, as SOAK_DIR/soak_NAME, beside SOAK_DIR/fathom_soak with all defences. Prints what the
same transactions give with and without it."""
import os
import re
import subprocess
import sys

TABLE = [  # program, what is off, where it matters, in how many transactions, and what has to show
    ('no_quarantine', 'a quarantined unit is asked at once', 'a16-real-time:late', 4000, 'old'),
    ('no_crc', 'the CRC of a response is not computed', 'a16-real-time:flip-byte', 4000, 'wrong'),
    ('no_unit', 'it is not looked whose response it is', 'a16-real-time:unit', 4000, 'wrong'),
    ('no_successor', 'whatever follows a frame ends it', 'a16-tight:drop', 60000, 'wrong'),
    ('no_successor', 'whatever follows a frame ends it', 'a16-auto:insert', 60000, 'wrong'),
    ('no_deadline', 'a silent stream is never stale', 'a16-auto:power-cycle', 4000, 'stuck'),
    ('no_quarantine_due', 'fathom_due_us forgets when a quarantine ends', 'a16-processed:unit', 4000, 'stuck'),
]
COLUMNS = ('transactions', 'readings', 'wrong', 'old', 'most', 'stuck')


def soak(program, only, transactions):
    """(exit status, {column: figure}) of the line of that sensor and fault."""
    done = subprocess.run([os.path.join(os.environ['SOAK_DIR'], program), '--transactions', str(transactions), '--only', only],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    sensor, fault = only.split(':')
    found = re.search(rf'^{re.escape(sensor)} +{re.escape(fault)} +(.+)$', done.stdout, re.M)
    if not found:
        print(done.stdout)
        return done.returncode, None
    return done.returncode, dict(zip(COLUMNS, map(float, found[1].split())))


def matters(program, only, transactions, column):
    """The figures with and without the defence, or None and why it does not matter."""
    sound, with_it = soak('fathom_soak', only, transactions)
    _, without = soak('soak_' + program, only, transactions)
    if with_it is None or without is None:
        return None, 'there is no such line'
    if sound != 0:
        return None, 'a rule is broken with the defence too'
    if with_it[column] != 0 or without[column] == 0:
        return None, f'{column}: {with_it[column]:.0f} with it, {without[column]:.0f} without'
    return (with_it[column], without[column]), ''


def main():
    failed = 0
    print(f'{"off":46} {"sensor and fault":26} {"shows":6} {"with":>6} {"without":>8}  transactions')
    for program, what, only, transactions, column in TABLE:
        figures, why = matters(program, only, transactions, column)
        if figures:
            print(f'{what:46} {only:26} {column:6} {figures[0]:6.0f} {figures[1]:8.0f}  {transactions}')
        else:
            print(f'{what:46} {only:26} FAILED: {why}')
            failed += 1
    print(f'{len(TABLE) - failed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
