#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the suites of tests/unit and tests/devices/sim that were built for another machine, two at a time.

    run.py TARGET IMAGES RUNNER [ARGUMENT...]

TARGET is avr or powerpc; IMAGES the folder with its programs; RUNNER what runs one, with {} in its place. A
suite passes when the last words are cmocka's, when they say that all cases passed, and when its program ends with 0.
What is left out has its line in left_out.txt; but with FATHOM_LONG in the environment what waits for the long run is
run too. The last line is "N passed, 0 failed"."""
import concurrent.futures
import glob
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TESTS = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(TESTS, 'checks'))
from count import cases  # noqa: E402: it counts what the host's tests print, and these print the same

# A target with fewer cases than this has lost some.
AT_LEAST = {'avr': 700, 'powerpc': 1950}
SECONDS = 500  # for one suite; a busy machine is slow, not wrong


def left_out(target):
    """{suite: set of its cases, empty for all of it}"""
    with open(os.path.join(HERE, 'left_out.txt'), encoding='utf-8') as file:
        lines = re.findall(rf'^{target} (\w+)(?:\.(\w+))?: (.+)$', file.read(), re.M)
    table = {}
    for suite, case, why in lines:
        if not (why.endswith('in the long run') and 'FATHOM_LONG' in os.environ):
            table.setdefault(suite, set()).update({case} if case else set())
    return table, len(lines)


def run(command):
    """(passed, failed, what it printed)"""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=SECONDS, check=False)
        printed, status = done.stdout.decode(errors='replace'), done.returncode
    except subprocess.TimeoutExpired as slow:
        printed, status = (slow.stdout or b'').decode(errors='replace') + '\nruns for ever', 'none'
    passed, failed = cases('unit', printed) or (0, 1)
    if status != 0:
        printed += f'\nexit status {status}'
        failed = max(failed, 1)
    if not failed and not passed:
        printed += '\nno case ran'
        failed = 1
    return passed, failed, printed


def main():
    target, images, command = sys.argv[1], sys.argv[2], sys.argv[3:]
    problems = []
    absent, lines = left_out(target)
    is_avr = target == 'avr'  # where each suite is a program
    kinds = {os.path.basename(path)[:-2]: os.path.basename(folder) for folder in ('unit', 'devices/sim')
             for path in glob.glob(os.path.join(TESTS, folder, 'test_*.c'))}
    wanted = {name for name, kind in kinds.items() if not (is_avr and kind == 'sim')}
    for name in sorted(set(absent) - wanted):
        problems.append(f'{name} is left out, but there is no such test')
    wanted -= {name for name, some in absent.items() if not some}
    passed = failed = 0
    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        names = sorted(wanted)
        commands = [[part.replace('{}', os.path.join(images, name if is_avr else 'test_' + kinds[name]))
                     for part in command] + ([] if is_avr else [name]) for name in names]
        for name, (good, bad, printed) in zip(names, pool.map(run, commands)):
            gone = set(re.findall(r'^\[ LEFT OUT \] (\w+)$', printed, re.M))
            if gone != absent.get(name, set()):
                bad += 1
                printed += '\nleft out: ' + ', '.join(sorted(gone))
            passed, failed = passed + good, failed + bad
            if bad:
                print(f'{name}:', *printed.splitlines(), sep='\n    ')
    if passed < AT_LEAST[target]:
        problems.append(f'{passed} cases passed, {AT_LEAST[target]} did when this number was kept')
    print(*problems, f'{target}: {len(wanted)} suites, {lines} suites or cases left out', sep='\n')
    print(f'{passed} passed, {failed + len(problems)} failed')
    return 1 if failed or problems else 0


if __name__ == '__main__':
    sys.exit(main())
