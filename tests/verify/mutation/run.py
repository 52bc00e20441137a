#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Tries mutants of the sources: is each of them seen by a test?

    run.py --all                     all of src/
    run.py --changed --sample 400    those of the files that changed since the figures were kept, and some of the others
    run.py FILE ...                  all of these; here and with --all, --record keeps the figures, in figures.csv
    run.py --only src/engine/line.c:220     those of one line, or the one of an identity, with what sees them
    run.py --ports [N]               some of each port, of which only the figures are told
    run.py --list [FILE ...]         only lists them
    run.py --self-test               shows that it can fail

A mutant is killed when a test that executes its line fails, crashes or takes some times as long as it usually does. One
whose optimised object is the same as before is not counted, and one that is no C is not made. What survives fails,
unless survivors.py lists it with the reason why it means the same; the slow tests do not look at those. In a sample
what survives is told, and fails where fewer than 95 % are killed: which ones it meets is chance."""
import argparse
import collections
import concurrent.futures
import csv
import difflib
import hashlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

import firmware
from bench import ROOT, Bench, Broken
from listed import Listed
from mutants import mutants_of
from ports import HOST, PortBench
from syntax import library
from trial import KILLED, NOT_C, SAME_CODE, SURVIVED, Trial

HERE = os.path.dirname(os.path.abspath(__file__))
FIGURES = os.path.join(HERE, 'figures.csv')
COLUMNS = ['commit', 'date', 'module', 'source', 'made', 'same_code', 'killed', 'survived', 'listed', 'seconds']
SHARE = 95  # percent of what can be killed in src/


def processor_s():
    used = os.times()
    return used.children_user + used.children_system


def module_of(mutant):
    """Its file; of a port's the folder."""
    parts = mutant.file.split('/')
    return '/'.join(parts[:2]) if parts[0] == 'port' else mutant.file


def digest(path):
    with open(os.path.join(ROOT, path), 'rb') as file:
        return hashlib.sha256(file.read()).hexdigest()[:12]


def kept():
    """The last row of each file."""
    if not os.path.exists(FIGURES):
        return []
    with open(FIGURES, encoding='utf-8', newline='') as file:
        rows = list(csv.DictReader(file))
    return list({row['module']: row for row in rows}.values())


def commit():
    done = subprocess.run(['git', 'rev-parse', 'HEAD'], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True, check=False)
    return done.stdout.strip()[:12] if done.returncode == 0 else ''


def diff(mutant, text):
    name = mutant.file
    lines = difflib.unified_diff(text.splitlines(), mutant.applied(text).splitlines(), name, name, n=1, lineterm='')
    return '\n'.join('    ' + line for line in list(lines)[2:])


class Report:
    """What came of each mutant, by module."""

    def __init__(self, listed):
        self.listed = listed
        self.trial = None
        self.results = []
        self.problems = []
        self.unlisted = []

    def add(self, result):
        self.results.append(result)
        mutant, is_listed = result.mutant, result.mutant in self.listed
        where = f'{mutant.file}:{mutant.line}'
        if result.status == SURVIVED and not is_listed:
            self.unlisted.append(result)
            print(f'{where}: SURVIVED {result.tests} tests\n    {mutant.identity}\n'
                  f'{diff(mutant, self.trial.text_of(mutant.file))}', flush=True)
        elif result.status != SURVIVED and is_listed:
            self.problems.append(result)
            how = f'{result.killer} {result.how}' if result.status == KILLED else result.status
            print(f'{where}: survivors.py lists it, but: {how}\n    {mutant.identity}', flush=True)

    def tell_gone(self):
        """Rows of survivors.py that are not made any more."""
        for identity in self.listed.gone:
            self.problems.append(identity)
            print(f'survivors.py lists what is not made any more:\n    {identity}', flush=True)

    def figures(self):
        """A row a module: made, same code, killed, survived, listed, seconds."""
        rows = collections.defaultdict(lambda: [0, 0, 0, 0, 0, 0.0])
        for result in self.results:
            if result.status == NOT_C:
                continue
            row = rows[module_of(result.mutant)]
            row[0] += 1
            row[1] += result.status == SAME_CODE
            row[2] += result.status == KILLED
            row[3] += result.status == SURVIVED
            row[4] += result.status == SURVIVED and result.mutant in self.listed
            row[5] += result.seconds
        return dict(sorted(rows.items()))

    def table(self):
        rows = self.figures()
        rows['all'] = [sum(column) for column in zip(*rows.values())] or [0] * 6
        print(f'\n{"module":28}{"made":>7}{"same code":>11}{"killed":>8}{"survived":>10}{"listed":>8}{"seconds":>9}')
        for module, row in rows.items():
            print(f'{module:28}{row[0]:7}{row[1]:11}{row[2]:8}{row[3]:10}{row[4]:8}{row[5]:9.0f}')
        made, same, killed, _, of_list, _ = rows['all']
        possible = made - same - of_list
        if possible:
            print(f'{100 * killed / possible:.1f} % of those that a test can see are killed')
        return killed, of_list, 100 * killed >= SHARE * possible

    def record(self):
        """The figures of whole files; those of the runs before stay."""
        is_new = not os.path.exists(FIGURES)
        with open(FIGURES, 'a', encoding='utf-8', newline='') as file:
            writer = csv.writer(file, lineterminator='\n')
            if is_new:
                writer.writerow(COLUMNS)
            today = time.strftime('%Y-%m-%d')
            for module, row in self.figures().items():
                writer.writerow([commit(), today, module, digest(module), *row[:5], round(row[5])])


def seed_of(options):
    return options.seed if options.seed is not None else int(commit() or time.strftime('%Y%m%d'), 16)


def chosen(options, mutants, listed):
    """What the options say is to be tried."""
    files = set(options.files)
    if options.all:
        files = set(library())
    if options.changed:
        before = {row['module']: row['source'] for row in kept()}
        files |= {path for path in library() if before.get(path) != digest(path)}
        print('changed since the figures were kept:', *(sorted(files) or ['nothing']))
    if options.only:
        place = options.only.rpartition(':')
        return [mutant for mutant in mutants if options.only == mutant.identity or
                (mutant.file == place[0] and place[2] == str(mutant.line))]
    found = [mutant for mutant in mutants if mutant.file in files]
    if options.sample:
        seed = seed_of(options)
        rest = [mutant for mutant in mutants if mutant.file not in files and mutant not in listed]
        sample = random.Random(seed).sample(rest, min(options.sample, len(rest)))
        print(f'a sample of {len(sample)} of {len(rest)}: --seed {seed}')
        found += sorted(sample, key=lambda mutant: (mutant.file, mutant.start))
    return found


def try_ports(options):
    """Some of the ports' mutants, whose figures are told and fail nothing."""
    report = Report(Listed([]))
    seed = seed_of(options)
    print(f'{options.ports} mutants a port: --seed {seed}')

    def sample(mutants):
        return random.Random(seed).sample(mutants, min(options.ports, len(mutants)))
    bench = PortBench(os.path.abspath(options.build), options.jobs)
    bench.prepare()
    report.trial = Trial(bench)
    files = bench.files()
    chosen_ones = [mutant for port in HOST for mutant in sample(
        [mutant for path in files if path.startswith(port + '/') for mutant in mutants_of(path)])]
    for result in report.trial.attempt_all(chosen_ones):
        report.add(result)
    with tempfile.TemporaryDirectory(prefix='fathom-firmware.') as folder, \
            concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        of_machines = pool.map(lambda name: firmware.results(name, folder, sample), firmware.TARGETS)
        for name, found in zip(firmware.TARGETS, of_machines):
            if found is None:
                print(f'{name}: left out, since no test of it passes; its tools may be missing')
            for result in found or []:
                report.add(result)
    report.table()
    print(f'{len(report.results)} passed, 0 failed')
    return 0 if report.results else 1


def try_them(options):
    paths = sorted(set(library()) | set(options.files))
    all_of_them = [mutant for path in paths for mutant in mutants_of(path)]
    report = Report(Listed(all_of_them))
    mutants = chosen(options, all_of_them, report.listed)
    if options.list:
        for mutant in mutants if len(options.files) or options.all else all_of_them:
            print(f'{mutant.file}:{mutant.line}: {mutant.identity}')
        return 0
    bench = Bench(os.path.abspath(options.build), options.jobs)
    bench.prepare()
    report.trial = Trial(bench, lambda mutant: options.quick or mutant in report.listed)
    report.tell_gone()
    began, used_before = time.time(), processor_s()
    for count, result in enumerate(report.trial.attempt_all(mutants), 1):
        report.add(result)
        if options.only:
            print(f'{result.status}{" by " + result.killer + ", which " + result.how if result.killer else ""}: '
                  f'{result.mutant.identity}\n{diff(result.mutant, report.trial.text_of(result.mutant.file))}')
        elif count % 500 == 0:
            print(f'-- {count} of {len(mutants)}, {time.time() - began:.0f} s', flush=True)
    print(f'{len(mutants)} in {time.time() - began:.0f} s, {processor_s() - used_before:.0f} s of the processors')
    killed, of_list, is_enough = report.table()
    failed = len(report.problems)
    if options.sample and not options.all:
        failed += not is_enough
    else:
        failed += len(report.unlisted)
    if options.record:
        report.record()
    print(f'{killed + of_list} passed, {failed} failed')
    return 1 if failed or not mutants else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--all', action='store_true', help='all of src/')
    parser.add_argument('--changed', action='store_true', help='files that changed since their figures were kept')
    parser.add_argument('--sample', type=int, metavar='N', default=0, help='and so many of the others')
    parser.add_argument('--seed', type=int, help='of the sample; else the commit is')
    parser.add_argument('--only', metavar='FILE:LINE', help='these, or the one of an identity, and what sees them')
    parser.add_argument('--list', action='store_true', help='only list them')
    parser.add_argument('--quick', action='store_true', help='without the slow tests, which may see what survives')
    parser.add_argument('--record', action='store_true', help='keep the figures of the files')
    parser.add_argument('--ports', type=int, metavar='N', nargs='?', const=10, default=0,
                        help='instead: a sample of so many a port')
    parser.add_argument('--self-test', action='store_true', help='show that it can fail')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build-mutation'), help='the build folder')
    parser.add_argument('-j', '--jobs', type=int, default=os.cpu_count() or 1)
    parser.add_argument('files', nargs='*', metavar='FILE')
    options = parser.parse_args()
    if options.record and (options.sample or options.only or options.ports):
        parser.error('--record keeps the figures of whole files')
    if options.self_test:
        import self_test  # pylint: disable=import-outside-toplevel
        return self_test.main()
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(f'ended by signal {number}'))  # and cleans up
    try:
        return try_ports(options) if options.ports else try_them(options)
    except Broken as error:
        print(f'{error}\n0 passed, 1 failed')
        return 1


if __name__ == '__main__':
    sys.exit(main())
