#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fails if the tests do not execute a line, branch or condition of the library or of a port, unless a reason is given.

    run.py --quick       builds the library and the ports for Linux in build-mcdc, and runs the tests in C

impossible.py names what no test executes, with the reasons."""
import argparse
import os
import sys

import c_code
from c_code import Broken
from impossible import IMPOSSIBLE

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))


class Verdict:
    """One check after the other, and how many failed."""

    def __init__(self):
        self.passed, self.problems = 0, []

    def check(self, name, problems):
        print(f'{"passed" if not problems else "FAILED"}  {name}')
        for problem in problems:
            print(f'    {problem}')
        self.problems += problems
        self.passed += not problems


def share(part, whole):
    return f'{whole - part} of {whole}'


def missed(files):
    """Returns {(path, what, source text): line} of what no test executes."""
    return {(path, part.what, part.text): part.line for path, file in sorted(files.items()) for part in file.missed()}


def lines_of(found):
    return [f'{path}:{line}: no test executes the {what} of: {text}' for (path, what, text), line in found.items()]


def judge_c(verdict, files, unsupported):
    rows = {path: file.counts() for path, file in files.items()}
    for folder in c_code.FOLDERS:
        total = [sum(row[i] for name, row in rows.items() if name.startswith(folder + '/')) for i in range(6)]
        print(f'{folder + ":":18} {share(total[1], total[0]):>14} lines, {share(total[3], total[2]):>14} branches, '
              f'{share(total[5], total[4]):>12} conditions (MC/DC)')
    verdict.check('clang instruments every decision', [f'{path}:{line}: {why}' for path, line, why in unsupported])
    found = missed(files)
    verdict.check('the tests execute every line, branch and condition',
                  lines_of({key: line for key, line in found.items() if key not in IMPOSSIBLE}))
    verdict.check(f'IMPOSSIBLE of impossible.py has {len(IMPOSSIBLE)} entries, and needs each',
                  [f'{" | ".join(key)}: is executed, or is gone' for key in IMPOSSIBLE if key not in found])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true', help='as without it')
    parser.add_argument('-j', '--jobs', type=int, default=os.cpu_count())
    options = parser.parse_args()
    verdict = Verdict()
    try:
        judge_c(verdict, *c_code.measure(ROOT, os.path.join(ROOT, 'build-mcdc'), options.jobs))
    except Broken as error:
        verdict.check('it can be measured', [str(error)])
    failed = len(verdict.problems)
    print(f'{verdict.passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
