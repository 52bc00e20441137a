#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts the test cases that ran, by kind and run, and holds them against tests/counts.txt.

    count.py [--update] [--gates N] RUN.xml ... RUN.txt ...

RUN.xml is what ctest --output-junit wrote; RUN.txt what a program printed whose last line is "12 passed, 0 failed".
A case is a cmocka test, what a script says it passed in such a line, or a check. N gates that were not met, such as
the coverage, count as failures. It fails when a test failed, was skipped, did not run or does not tell its number,
and when a run that tests/counts.txt knows has fewer cases of a kind, or a kind that is not there. The last line is
the sum over all runs."""
import argparse
import os
import re
import sys
import tempfile
import xml.etree.ElementTree as ET

KEPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'counts.txt')
TOLD = r'^(\d+) passed, (\d+) failed$'


def cases(kind, printed):
    """(passed, failed) of a test that ran, or None when it does not tell."""
    if kind in ('check', 'selfcheck'):
        return 1, 0
    cmocka = re.findall(r'^\[=+\] .*?(\d+) test\(s\) run\.', printed, re.M)
    if cmocka:
        passed = re.findall(r'^\[\s+PASSED\s+\] (\d+) test\(s\)\.', printed, re.M)
        passed = sum(int(number) for number in passed)
        return passed, sum(int(number) for number in cmocka) - passed
    counted = re.findall(TOLD, printed, re.M)
    if counted:
        return sum(int(p) for p, _ in counted), sum(int(f) for _, f in counted)
    return None


def judge(status, kind, printed):
    """(passed, failed, what is wrong with it) of one test of ctest's."""
    told = cases(kind, printed)
    if status == 'fail':
        good, bad = (0, 1) if kind in ('check', 'selfcheck') else told or (0, 1)
        return good, max(bad, 1), 'failed'
    if status != 'run':
        return 0, 1, 'did not run'
    if told is None:
        return 0, 1, 'does not tell how many cases it had'
    return *told, f'left out {told[1]} cases' if told[1] else None


def read(path, problems):
    """{kind: passed} and the number of failures of one run."""
    if path.endswith('.txt'):
        with open(path, encoding='utf-8') as file:
            told = re.search(TOLD + r'\n*\Z', file.read(), re.M)
        if not told:
            problems.append(f'{path}: its last line does not tell how many cases it had')
        return {name_of(path): int(told[1]) if told else 0}, int(told[2]) if told else 1
    passed, failed = {}, 0
    for test in ET.parse(path).getroot().iter('testcase'):
        name = test.get('name')
        kind = name.split('.')[0]
        good, bad, problem = judge(test.get('status'), kind, test.findtext('system-out') or '')
        if problem:
            problems.append(f'{path}: {name} {problem}')
        passed[kind] = passed.get(kind, 0) + good
        failed += bad
    return passed, failed


def name_of(path):
    return os.path.splitext(os.path.basename(path))[0]


def kept_counts(text):
    """{(run, kind): cases} of lines KIND NUMBER RUN..."""
    return {(run, kind): int(number) for kind, number, runs in re.findall(r'^(\w+) (\d+) (.+)$', text, re.M)
            for run in runs.split()}


def count(paths, kept):
    """(lines to print, passed, failed, {run: {kind: cases}})"""
    problems = []
    results = {name_of(path): read(path, problems) for path in paths}
    kinds = sorted({kind for passed, _ in results.values() for kind in passed})
    lines = [' '.join([f'{"kind":10}', *(f'{run:>{max(8, len(run))}}' for run in results)])]
    failed = sum(bad for _, bad in results.values())
    for kind in kinds:
        lines.append(' '.join([f'{kind:10}', *(f'{passed.get(kind, 0):>{max(8, len(run))}}'
                                               for run, (passed, _) in results.items())]))
    for (run, kind), least in kept.items():
        has = results[run][0].get(kind, 0) if run in results else least
        if has < least:
            problems.append(f'{run}: {has} cases of kind {kind}, tests/counts.txt has {least}')
            failed += 1
    for run, (passed, _) in results.items():
        for kind in set(passed) - {kept_kind for kept_run, kept_kind in kept if kept_run == run}:
            problems.append(f'{run}: the kind {kind} is not in tests/counts.txt')
            failed += any(kept_run == run for kept_run, _ in kept)
    ran = {run: passed for run, (passed, _) in results.items()}
    return lines + problems, sum(sum(passed.values()) for passed in ran.values()), failed, ran


def update(kept, ran):
    """The new text of counts.txt: runs that were not made keep their numbers."""
    kept = {key: number for key, number in kept.items() if key[0] not in ran}
    kept.update({(run, kind): number for run, passed in ran.items() for kind, number in passed.items()})
    rows = {}
    for (run, kind), number in sorted(kept.items()):
        rows.setdefault((kind, number), []).append(run)
    return '\n'.join(['# KIND NUMBER RUN...: how many test cases of a kind a run has at least. tests/checks/count.py',
                      "# --update build-logs/RUN.* keeps today's.",
                      *(f'{kind} {number} {" ".join(runs)}' for (kind, number), runs
                                            in sorted(rows.items()))]) + '\n'


def self_test():
    """Results as ctest writes them, with faults."""
    def ran(name, printed, status='run'):
        return f'<testcase name="{name}" status="{status}"><system-out>{printed}</system-out></testcase>'

    good = '[==========] 3 test(s) run.\n[  PASSED  ] 3 test(s).\n'
    skipped = '[==========] 3 test(s) run.\n[  PASSED  ] 2 test(s).\n[  SKIPPED ] 1 test(s), listed below:\n'
    full = ran('unit.a', good) + ran('e2e.b', '4 passed, 0 failed\n') + ran('check.c', '')
    kept = 'unit 3 RUN\ne2e 4 RUN\ncheck 1 RUN\nother 7 absent\n'
    table = [  # results, kept, failures, words
        (full, kept, 0, ''),
        (full, kept.replace('unit 3', 'unit 4'), 1, '3 cases of kind unit, tests/counts.txt has 4'),
        (full, kept.replace('check 1 RUN\n', ''), 1, 'check is not in tests/counts.txt'),
        (full, kept + 'golden 1 RUN\n', 1, '0 cases of kind golden'),
        (full + ran('unit.d', skipped), kept, 1, 'unit.d left out 1 cases'),
        (full + ran('unit.d', 'crash', 'fail'), kept, 1, 'unit.d failed'),
        (full + ran('check.d', '', 'fail'), kept, 1, 'check.d failed'),
        (full + ran('e2e.d', '3 passed, 1 failed', 'fail'), kept, 1, 'e2e.d failed'),
        (full + ran('e2e.d', '3 passed, 1 failed'), kept, 1, 'e2e.d left out'),
        (full + ran('e2e.d', ''), kept, 1, 'does not tell'),
        (full + ran('e2e.d', '', 'notrun'), kept, 1, 'did not run'),
        (full + ran('e2e.d', '', 'disabled'), kept, 1, 'did not run'),
        ('line\n5 passed, 0 failed\n', 'RUN 5 RUN\n', 0, ''),
        ('5 passed, 2 failed\n', 'RUN 5 RUN\n', 2, ''),
        ('5 passed, 0 failed\nkilled\n', 'RUN 0 RUN\n', 1, 'does not tell'),
    ]
    wrong = 0
    for text, numbers, failures, words in table:
        is_xml = text.startswith('<')
        with tempfile.NamedTemporaryFile('w', suffix='.xml' if is_xml else '.txt') as file:
            file.write(f'<testsuite>{text}</testsuite>' if is_xml else text)
            file.flush()
            lines, _, failed, _ = count([file.name], kept_counts(numbers.replace('RUN', name_of(file.name))))
        if failed != failures or not any(words in line for line in lines):
            print(f'{words!r}: {failed} failures, expected {failures}', *lines, sep='\n')
            wrong += 1
    print(f'{len(table)} results, {len(table) - wrong} judged right')
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--self-test', action='store_true', help='show that it can fail')
    parser.add_argument('--update', action='store_true', help='keep the numbers of these runs')
    parser.add_argument('--gates', type=int, default=0, metavar='N', help='gates that were not met')
    parser.add_argument('results', nargs='*', metavar='RUN', help='a file of results')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    with open(KEPT, encoding='utf-8') as file:
        kept = kept_counts(file.read())
    lines, passed, failed, ran = count(options.results, kept)
    if options.update:
        with open(KEPT, 'w', encoding='utf-8') as file:
            file.write(update(kept, ran))
    if options.gates:
        lines.append(f'{options.gates} stages failed, see above')
        failed += options.gates
    print('\n'.join(lines))
    print(f'{passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
