#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Adds up the test cases that ran, by kind and run, and fails if one of them failed.

    count.py [--gates N] RUN.xml ... RUN.txt ...

RUN.xml is written by ctest --output-junit. RUN.txt is the output of a program whose last line is "12 passed, 0 failed".
A case is a cmocka test, a case that a script counts in such a line, or a script of the kinds checks and bench. A test
that was skipped, did not run or does not report its number of cases fails. N stages that failed count as failures. The
numbers are printed and not compared; registered.py sees that no test is lost. The last line is the sum of all runs."""
import argparse
import os
import re
import sys
import xml.etree.ElementTree as ET

REPORTED = r'^(\d+) passed, (\d+) failed$'


def cases(kind, printed):
    """Returns (passed, failed) of a test that ran, or None if its output has no number of cases."""
    cmocka = re.findall(r'^\[=+\] .*?(\d+) test\(s\) run\.', printed, re.M)
    if cmocka:
        passed = sum(int(number) for number in re.findall(r'^\[\s+PASSED\s+\] (\d+) test\(s\)\.', printed, re.M))
        return passed, sum(int(number) for number in cmocka) - passed
    counted = re.findall(REPORTED, printed, re.M)
    if counted:
        return sum(int(p) for p, _ in counted), sum(int(f) for _, f in counted)
    return (1, 0) if kind in ('checks', 'bench') else None


def judge(status, kind, printed):
    """Returns (passed, failed, problem) of one test of CTest's."""
    reported = cases(kind, printed)
    if status == 'fail':
        passed, failed = (0, 1) if kind in ('checks', 'bench') else reported or (0, 1)
        return passed, max(failed, 1), 'failed'
    if status != 'run':
        return 0, 1, 'did not run'
    if reported is None:
        return 0, 1, 'does not report how many cases it has'
    return *reported, f'left out {reported[1]} cases' if reported[1] else None


def read(path, problems):
    """Returns {kind: passed} and the number of failures of one run."""
    if path.endswith('.txt'):
        with open(path, encoding='utf-8') as file:
            reported = re.search(REPORTED + r'\n*\Z', file.read(), re.M)
        if not reported:
            problems.append(f'{path}: its last line does not report how many cases it has')
            return {name_of(path): 0}, 1
        return {name_of(path): int(reported[1])}, int(reported[2])
    passed, failed = {}, 0
    for test in ET.parse(path).getroot().iter('testcase'):
        name = test.get('name')
        kind = name.split('.')[0]
        good, bad, problem = judge(test.get('status'), kind, test.findtext('system-out') or '')
        if problem:
            problems.append(f'{path}: {name} {problem}')
        passed[kind] = passed.get(kind, 0) + good
        failed += bad
    if not passed:
        problems.append(f'{path}: no test ran')
        failed += 1
    return passed, failed


def name_of(path):
    return os.path.splitext(os.path.basename(path))[0]


def count(paths):
    """Returns (lines to print, passed, failed)."""
    problems = []
    results = {name_of(path): read(path, problems) for path in paths}
    lines = [f'{"kind":12}' + ''.join(f' {run:>8}' for run in results)]
    for kind in sorted({kind for passed, _ in results.values() for kind in passed}):
        lines.append(f'{kind:12}' + ''.join(f' {passed.get(kind, 0):>{max(8, len(run))}}'
                                            for run, (passed, _) in results.items()))
    passed = sum(sum(passed.values()) for passed, _ in results.values())
    return lines + problems, passed, sum(failed for _, failed in results.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--gates', type=int, default=0, metavar='N', help='stages that failed')
    parser.add_argument('results', nargs='*', metavar='RUN', help='a file of results')
    options = parser.parse_args()
    lines, passed, failed = count(options.results)
    if options.gates:
        lines.append(f'{options.gates} stages failed, see above')
        failed += options.gates
    print('\n'.join(lines))
    print(f'{passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
