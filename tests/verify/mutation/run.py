#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes mutants of the sources, and reports each that no test detects.

    run.py --all                     all mutants of src/
    run.py --changed                 the mutants of the files of src/ that git reports as changed since the last tag
    run.py --sample 400              400 mutants of src/; with --changed, half of them of the changed files
    run.py FILE ...                  the mutants of these files
    run.py --only src/engine/line.c:220     the mutants of one line, or of one identity, with the test that kills each
    run.py --list [FILE ...]         only lists the mutants

A mutant is killed if a test that executes its line fails, crashes or takes several times its usual time. A mutant that
compiles to the same optimised object is not counted, and neither is one that does not compile. A survivor fails, unless
survivors.py lists it with the reason why it means the same; the slow tests do not run on listed mutants. A sample
prints its survivors, and fails if less than 95 % are killed."""
import argparse
import collections
import difflib
import os
import random
import signal
import subprocess
import sys
import time

from bench import ROOT, Bench, Broken
from listed import Listed
from mutants import mutants_of
from syntax import library
from trial import KILLED, NOT_C, SAME_CODE, SURVIVED, Trial

SHARE = 95  # percent of the mutants of src/ that a test can kill


def processor_s():
    used = os.times()
    return used.children_user + used.children_system


def git(*words):
    done = subprocess.run(['git', *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          check=False)
    return done.stdout.split() if done.returncode == 0 else []


def commit():
    return ''.join(git('rev-parse', 'HEAD'))[:12]


def changed_files():
    """Returns the files of src/ that changed since the last tag, or in the last 20 commits if there is no tag."""
    base = (git('describe', '--tags', '--abbrev=0') or git('rev-parse', '--verify', 'HEAD~20') or
            git('rev-list', '--max-parents=0', 'HEAD'))
    if not base:
        raise Broken('--changed needs the history of git')
    files = {*git('diff', '--name-only', base[0], '--', 'src'), *git('ls-files', '--others', 'src')} & set(library())
    print(f'changed since {base[0][:12]}:', *(sorted(files) or ['no file of src/']))
    return files


def diff(mutant, text):
    name = mutant.file
    lines = difflib.unified_diff(text.splitlines(), mutant.applied(text).splitlines(), name, name, n=1, lineterm='')
    return '\n'.join('    ' + line for line in list(lines)[2:])


class Report:
    """What came of each mutant, by file."""

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
            row = rows[result.mutant.file]
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


def seed_of(options):
    return options.seed if options.seed is not None else int(commit() or time.strftime('%Y%m%d'), 16)


def chosen(options, mutants, listed):
    """Returns the mutants that the options select."""
    if options.only:
        place = options.only.rpartition(':')
        return [mutant for mutant in mutants if options.only == mutant.identity or
                (mutant.file == place[0] and place[2] == str(mutant.line))]
    files = set(library()) if options.all else set(options.files) | (changed_files() if options.changed else set())
    first = [mutant for mutant in mutants if mutant.file in files]
    if not options.sample:
        return first
    random_of_seed = random.Random(seed_of(options))
    rest = [mutant for mutant in mutants if mutant.file not in files and mutant not in listed]
    found = random_of_seed.sample(first, min(options.sample // 2, len(first)))
    found += random_of_seed.sample(rest, min(options.sample - len(found), len(rest)))
    print(f'a sample of {len(found)} of {len(first) + len(rest)}: --seed {seed_of(options)}')
    return sorted(found, key=lambda mutant: (mutant.file, mutant.start))


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
    if options.sample:
        failed += not is_enough
    else:
        failed += len(report.unlisted)
    print(f'{killed + of_list} passed, {failed} failed')
    return 1 if failed or not mutants else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--all', action='store_true', help='all of src/')
    parser.add_argument('--changed', action='store_true', help='files changed since the last tag, or in 20 commits')
    parser.add_argument('--sample', type=int, metavar='N', default=0, help='N mutants, half of them of the named files')
    parser.add_argument('--seed', type=int, help='of the sample; else the commit is')
    parser.add_argument('--only', metavar='FILE:LINE', help='these, or the one of an identity, and what sees them')
    parser.add_argument('--list', action='store_true', help='only list them')
    parser.add_argument('--quick', action='store_true', help='without the slow tests, which may see what survives')
    parser.add_argument('--build', default=os.path.join(ROOT, 'build-mutation'), help='the build folder')
    parser.add_argument('-j', '--jobs', type=int, default=os.cpu_count() or 1)
    parser.add_argument('files', nargs='*', metavar='FILE')
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(f'ended by signal {number}'))  # and cleans up
    try:
        return try_them(options)
    except Broken as error:
        print(f'{error}\n0 passed, 1 failed')
        return 1


if __name__ == '__main__':
    sys.exit(main())
