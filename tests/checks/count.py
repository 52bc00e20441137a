#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts the test cases that ran, by kind, and holds them against tests/counts.txt.

    count.py [--update] [--gates N] RESULTS.xml ...

RESULTS.xml is what ctest --output-junit writes; the first is that of the build which runs the checks and the
faults too. A case is a cmocka test, what a script of tests/e2e or tests/faults says it passed (a line
"12 passed, 0 failed"), or a check. N gates that were not met, such as the coverage, count as failures. It fails
when a test failed, was skipped, did not run or does not tell its number, and when a kind has fewer cases than
the number that is kept. The last line is the sum over all builds."""
import argparse
import os
import re
import sys
import tempfile
import xml.etree.ElementTree as ET

KEPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'counts.txt')
ONCE = ('check', 'faults', 'firmware')  # kinds that the first build alone runs
TWICE = ('e2e', 'interop')  # and these the last one too: they wait for serial lines, whatever the compiler


def cases(kind, printed):
    """(passed, failed) of a test that ran, or None when it does not tell."""
    if kind == 'check':
        return 1, 0
    cmocka = re.findall(r'^\[=+\] .*?(\d+) test\(s\) run\.', printed, re.M)
    if cmocka:
        passed = re.findall(r'^\[\s+PASSED\s+\] (\d+) test\(s\)\.', printed, re.M)
        passed = sum(int(number) for number in passed)
        return passed, sum(int(number) for number in cmocka) - passed
    counted = re.findall(r'^(\d+) passed, (\d+) failed$', printed, re.M)
    if counted:
        return sum(int(p) for p, _ in counted), sum(int(f) for _, f in counted)
    return None


def read(path, problems):
    """{kind: passed} and the number of failures of one build."""
    passed, failed = {}, 0
    for test in ET.parse(path).getroot().iter('testcase'):
        name = test.get('name')
        kind = name.split('.')[0]
        printed = test.findtext('system-out') or ''
        told = cases(kind, printed)
        if test.get('status') == 'fail':
            problems.append(f'{path}: {name} failed')
            good, bad = told or (0, 1)
            if kind == 'check':
                good, bad = 0, 1
            bad = max(bad, 1)
        elif test.get('status') != 'run':
            problems.append(f'{path}: {name} did not run')
            good, bad = 0, 1
        elif told is None:
            problems.append(f'{path}: {name} does not tell how many cases it had')
            good, bad = 0, 1
        else:
            good, bad = told
            if bad:
                problems.append(f'{path}: {name} left out {bad} cases')
        passed[kind] = passed.get(kind, 0) + good
        failed += bad
    return passed, failed


def kept_counts():
    with open(KEPT, encoding='utf-8') as file:
        return {kind: int(number) for kind, number in re.findall(r'^(\w+) (\d+)$', file.read(), re.M)}


def count(paths, kept):
    """(lines to print, passed, failed, {kind: cases of the first build})"""
    problems = []
    results = [read(path, problems) for path in paths]
    first = results[0][0]
    kinds = sorted(set(kept) | {kind for passed, _ in results for kind in passed})
    builds = [os.path.basename(os.path.dirname(os.path.abspath(path))) for path in paths]
    wide = [max(8, len(build)) for build in builds]
    lines = [f'{"kind":10}' + ''.join(f' {b:>{w}}' for b, w in zip(builds, wide)) + f' {"at least":>8}']
    failed = sum(bad for _, bad in results)
    for kind in kinds:
        lines.append(f'{kind:10}' + ''.join(f' {passed.get(kind, 0):>{w}}' for (passed, _), w in zip(results, wide))
                     + f' {kept.get(kind, 0):>8}')
        last = len(results) - 1
        for number, (passed, _) in enumerate(results):
            must = number == 0 or (kind not in ONCE and (kind not in TWICE or number == last))
            if must and passed.get(kind, 0) < kept.get(kind, 0):
                problems.append(f'{builds[number]}: {passed.get(kind, 0)} cases of kind {kind}, '
                                f'tests/counts.txt has {kept[kind]}')
                failed += 1
        if kind not in kept:
            problems.append(f'{kind}: this kind is not in tests/counts.txt')
            failed += 1
        elif first.get(kind, 0) > kept[kind]:
            lines.append(f'  {kind}: more than are kept; count.py --update raises the number')
    return lines + problems, sum(sum(passed.values()) for passed, _ in results), failed, first


def self_test():
    """Results as ctest writes them, with faults."""
    def ran(name, printed, status='run'):
        return f'<testcase name="{name}" status="{status}"><system-out>{printed}</system-out></testcase>'

    good = '[==========] 3 test(s) run.\n[  PASSED  ] 3 test(s).\n'
    skipped = '[==========] 3 test(s) run.\n[  PASSED  ] 2 test(s).\n[  SKIPPED ] 1 test(s), listed below:\n'
    full = ran('unit.a', good) + ran('e2e.b', '4 passed, 0 failed\n') + ran('check.c', '')
    kept = {'unit': 3, 'e2e': 4, 'check': 1}
    table = [  # results, kept, failures, words
        (full, kept, 0, ''),
        (full, dict(kept, unit=4), 1, '3 cases of kind unit, tests/counts.txt has 4'),
        (full, {'unit': 3, 'e2e': 4}, 1, 'not in tests/counts.txt'),
        (full, dict(kept, golden=1), 1, '0 cases of kind golden'),
        (full + ran('unit.d', skipped), kept, 1, 'unit.d left out 1 cases'),
        (full + ran('unit.d', 'crash', 'fail'), kept, 1, 'unit.d failed'),
        (full + ran('check.d', '', 'fail'), kept, 1, 'check.d failed'),
        (full + ran('e2e.d', '3 passed, 1 failed', 'fail'), kept, 1, 'e2e.d failed'),
        (full + ran('e2e.d', '3 passed, 1 failed'), kept, 1, 'e2e.d left out'),
        (full + ran('e2e.d', ''), kept, 1, 'does not tell'),
        (full + ran('e2e.d', '', 'notrun'), kept, 1, 'did not run'),
        (full + ran('e2e.d', '', 'disabled'), kept, 1, 'did not run'),
    ]
    wrong = 0
    for results, numbers, failures, words in table:
        with tempfile.NamedTemporaryFile('w', suffix='.xml') as file:
            file.write(f'<testsuite>{results}</testsuite>')
            file.flush()
            lines, _, failed, _ = count([file.name], numbers)
        if failed != failures or not any(words in line for line in lines):
            print(f'{words!r}: {failed} failures, expected {failures}', *lines, sep='\n')
            wrong += 1
    print(f'{len(table)} results, {len(table) - wrong} judged right')
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--self-test', action='store_true', help='show that it can fail')
    parser.add_argument('--update', action='store_true', help='keep the numbers of the first build')
    parser.add_argument('--gates', type=int, default=0, metavar='N', help='gates that were not met')
    parser.add_argument('results', nargs='*', metavar='RESULTS.xml')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    lines, passed, failed, first = count(options.results, kept_counts())
    if options.gates:
        lines.append(f'{options.gates} gates were not met, see above')
        failed += options.gates
    print('\n'.join(lines))
    if options.update:
        with open(KEPT, 'w', encoding='utf-8') as file:
            print('# How many test cases of each kind there are at least; tests/checks/count.py --update', file=file)
            for kind, number in sorted(first.items()):
                print(kind, number, file=file)
    print(f'{passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
