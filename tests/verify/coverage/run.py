#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Fails if the tests do not execute a line, branch or condition of the library or of a port, unless a reason is given.

    run.py --quick       the library and the ports for Linux: builds them in build-mcdc, and runs the tests in C
    run.py --machines    the ports for microcontrollers: runs the firmware tests of a build folder (--build, build-gcc)
    run.py               both
    run.py --self-test   finds the planted fault

impossible.py names what no test executes, with the reasons."""
import argparse
import os
import shutil
import sys

import c_code
import machine_code
from c_code import Broken
from impossible import IMPOSSIBLE, UNREACHED

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
COPIED = ('CMakeLists.txt', 'LICENSE', 'README.md', 'include', 'src', 'port', 'examples', 'tests')
# The planted fault: a condition that never decides. The file, the old text, the new text and the expected problem.
FAULT = ('src/processing/median.c', '|| !is_full(median)) return false;',
         '|| !is_full(median) || (median->have > median->config.count)) return false;', 'condition 3')


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


def judge_machines(verdict, functions):
    """`functions` is {(file, name): whether some image executed it}."""
    for folder in sorted({os.path.dirname(file) for file, _ in functions}):
        of_folder = [is_reached for (file, _), is_reached in functions.items() if os.path.dirname(file) == folder]
        print(f'{folder}: {sum(of_folder)} of {len(of_folder)} functions')
    unreached = {key for key, is_reached in functions.items() if not is_reached}
    verdict.check('an image executes every function of the ports for microcontrollers',
                  [f'{file}: no image executes {name}' for file, name in sorted(unreached - set(UNREACHED))])
    verdict.check(f'UNREACHED of impossible.py has {len(UNREACHED)} entries, and knows each function',
                  [f'{file}: {name} is gone' for file, name in sorted(set(UNREACHED) - set(functions))])
    # The clock of QEMU is the host's, so an image may execute more in one run than in another: this must not fail.
    for file, name in sorted(set(UNREACHED) & set(functions) - unreached):
        print(f'    {file}: an image executes {name}, so its entry may go')


def self_test(verdict, jobs):
    """Plants FAULT in a copy of the tree, and finds it."""
    path, old, new, expected = FAULT
    folder = os.path.join(ROOT, 'build-mcdc-planted')
    tree = os.path.join(folder, 'tree')
    shutil.rmtree(tree, ignore_errors=True)
    os.makedirs(tree)
    for name in COPIED:
        source, target = os.path.join(ROOT, name), os.path.join(tree, name)
        (shutil.copytree if os.path.isdir(source) else shutil.copy2)(source, target)
    with open(os.path.join(tree, path), encoding='utf-8') as file:
        text = file.read()
    if text.count(old) != 1:
        raise Broken(f'{path} does not have {old!r} exactly once')
    with open(os.path.join(tree, path), 'w', encoding='utf-8') as file:
        file.write(text.replace(old, new))
    files, _ = c_code.measure(tree, os.path.join(folder, 'build'), jobs)
    found = [problem for problem in lines_of(missed(files)) if path in problem and expected in problem]
    verdict.check(f'planted {new!r}: {found[0] if found else ""}', [] if found else ['the fault is not found'])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--machines', action='store_true')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build-gcc'), help='where the firmware tests are built')
    parser.add_argument('-j', '--jobs', type=int, default=os.cpu_count())
    options = parser.parse_args()
    verdict = Verdict()
    try:
        if options.self_test:
            self_test(verdict, options.jobs)
        elif not options.machines:
            judge_c(verdict, *c_code.measure(ROOT, os.path.join(ROOT, 'build-mcdc'), options.jobs))
        if not options.self_test and not options.quick:
            build, folder = os.path.abspath(options.build), os.path.join(ROOT, 'build-mcdc-traces')
            machine_code.build_images(ROOT, build, options.jobs)
            machine_code.record(ROOT, build, folder, options.jobs)
            judge_machines(verdict, machine_code.measure(ROOT, build, folder))
    except Broken as error:
        verdict.check('it can be measured', [str(error)])
    failed = len(verdict.problems)
    print(f'{verdict.passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
