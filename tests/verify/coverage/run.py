#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What the tests execute, as a gate: MC/DC, branches and lines of the library and of the ports for Linux, instructions and
branches of the ports for microcontrollers.

    run.py --quick       the library and the ports for Linux: builds them in build-mcdc, and runs the tests in C
    run.py --machines    the ports for microcontrollers: runs the firmware tests of a build folder (--build, build-gcc)
    run.py               both
    run.py --self-test   plants faults, and sees each of them told
    --update             keeps better figures

The figures are in figures.csv and machines.csv. A figure that is worse fails; in the folders of COMPLETE everything is
executed but what impossible.py names."""
import argparse
import csv
import os
import sys

import c_code
import machine_code
from c_code import Broken
from impossible import IMPOSSIBLE

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
COMPLETE = ('include/', 'src/', 'port/serial/', 'port/posix/')
C_HEAD = ('file', 'lines', 'lines missed', 'branches', 'branches missed', 'conditions', 'conditions missed')
MACHINE_HEAD = ('file', 'functions', 'reached', 'instructions', 'executed', 'ways', 'taken')


def read_rows(path):
    if not os.path.exists(path):
        return {}
    with open(path, encoding='utf-8', newline='') as file:
        return {row[0]: tuple(map(int, row[1:])) for row in list(csv.reader(file))[1:]}


def write_rows(path, head, rows):
    with open(path, 'w', encoding='utf-8', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        writer.writerow(head)
        writer.writerows([name, *row] for name, row in sorted(rows.items()))


def c_missed(row):
    return row[1::2]


# QEMU's clock is the host's, so that interrupts come elsewhere in each run.
TIMED_BY_HOST = ('tests/firmware/mps2/port/', 'tests/firmware/virt/port/', 'port/stm32f4/')


def slack(name, row):
    """How much more than is kept may be missed: a thirtieth of the instructions, and two ways."""
    return (0, row[2] // 30, 2) if name.startswith(TIMED_BY_HOST) else (0, 0, 0)


def machine_missed(row):
    return tuple(row[i] - row[i + 1] for i in (0, 2, 4))


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
        return not problems


def compare(kept, rows, missed):
    """What is worse than it was; and whether something is better, or new."""
    worse = [f'{name}: {missed(row)} missed, {missed(kept[name])} were kept' for name, row in sorted(rows.items())
             if name in kept and any(now > was + more for now, was, more in
                                     zip(missed(row), missed(kept[name]), slack(name, row)))]
    worse += [f'{name} is not in the figures: --update' for name in sorted(rows) if name not in kept]
    worse += [f'{name} is in the figures, and no longer there: --update' for name in sorted(kept) if name not in rows]
    better = any(missed(row) != missed(kept.get(name, row)) for name, row in rows.items())
    return worse, better


def keep(verdict, path, head, rows, missed, update):
    worse, better = compare(read_rows(path), rows, missed)
    if update:
        write_rows(path, head, rows)
        for line in worse:
            print(f'    kept all the same: {line}')
        print(f'{os.path.basename(path)} is kept')
        return
    verdict.check(f'no figure is worse than in {os.path.basename(path)}', worse)
    if better and not worse:
        print(f'{os.path.basename(path)} could be better: --update keeps today\'s')


def share(part, whole):
    return f'{whole - part} of {whole}'


def judge_c(verdict, files, unsupported, listed=IMPOSSIBLE):
    """The gates of the library and of the ports for Linux; returns the rows of figures."""
    rows = {path: file.counts() for path, file in files.items()}
    for folder in c_code.FOLDERS:
        total = [sum(row[i] for name, row in rows.items() if name.startswith(folder + '/')) for i in range(6)]
        print(f'{folder + ":":18} {share(total[1], total[0]):>14} lines, {share(total[3], total[2]):>14} branches, '
              f'{share(total[5], total[4]):>12} conditions (MC/DC)')
    verdict.check('clang instruments every decision', [f'{path}:{line}: {why}' for path, line, why in unsupported])
    used, problems = set(), []
    for path, file in sorted(files.items()):
        for part in file.missed():
            key = (path, part.what, part.text)
            if key in listed:
                used.add(key)
            elif path.startswith(COMPLETE):
                problems.append(f'{path}:{part.line}: no test executes the {part.what} of: {part.text}')
    verdict.check(f'{", ".join(COMPLETE)}: every line, branch and condition', problems)
    verdict.check(f'impossible.py has {len(listed)} entries, each of them needed',
                  [f'{" | ".join(key)}: is executed, or is gone' for key in listed if key not in used])
    return rows


def judge_machines(rows):
    ports = {}
    for name, row in rows.items():
        total = ports.setdefault(name.rsplit('/', 1)[0], [0] * 6)
        for i, value in enumerate(row):
            total[i] += value
    for name, total in sorted(ports.items()):
        print(f'{name + ":":18} {total[1]} of {total[0]} functions, {total[3]} of {total[2]} instructions, '
              f'{total[5]} of {total[4]} ways of conditional branches')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--machines', action='store_true')
    parser.add_argument('--again', action='store_true', help='judges the traces of the last run of --machines')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--update', action='store_true')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build-gcc'), help='where the firmware tests are built')
    parser.add_argument('-j', '--jobs', type=int, default=os.cpu_count())
    options = parser.parse_args()
    verdict = Verdict()
    try:
        if options.self_test:
            import planting
            planting.self_test(verdict, ROOT, options.jobs)
        if not options.self_test and not options.machines and not options.again:
            files, unsupported = c_code.measure(ROOT, os.path.join(ROOT, 'build-mcdc'), options.jobs)
            rows = judge_c(verdict, files, unsupported)
            keep(verdict, os.path.join(HERE, 'figures.csv'), C_HEAD, rows, c_missed, options.update)
        if not options.self_test and not options.quick:
            build = os.path.abspath(options.build)
            folder = os.path.join(ROOT, 'build-mcdc-traces')
            if not options.again:
                machine_code.build_images(ROOT, build, options.jobs)
                machine_code.record(ROOT, build, folder, options.jobs)
            rows = machine_code.measure(ROOT, build, folder)
            judge_machines(rows)
            keep(verdict, os.path.join(HERE, 'machines.csv'), MACHINE_HEAD, rows, machine_missed, options.update)
    except Broken as error:
        verdict.check('it can be measured', [str(error)])
    failed = len(verdict.problems)
    print(f'{verdict.passed} passed, {failed} failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
