#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Shows by Frama-C's EVA that no input causes a run-time error: runs each harness on each model of a machine.

    eva.py [--quick] [--machine NAME] [HARNESS ...]   all harnesses, or those with HARNESS in their names
    eva.py --list

A harness is a file FOLDER/NAME.c whose main() calls the sources that it proves with any input. Its first comment has:

    proves:  the sources of which every function must be reached; patterns are allowed
    with:    (optional) further sources to link
    options: (optional) further options of Frama-C
    unreached: (optional) functions of `proves` that another harness reaches
    volatile: kept (optional; no without it)
    quick:   no (optional; yes without it)

EVA does not see `volatile`, unless the comment says that it is kept (see assumptions.h).

--quick: one machine, without the harnesses that say `quick: no`.

These fail: an alarm that remaining.py does not argue, a statement that no run reaches and remaining.py does not
explain, and a source of src/ that no harness proves."""
import argparse
import concurrent.futures
import csv
import glob
import os
import re
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, os.path.dirname(HERE))
import c_text  # noqa: E402
import remaining  # noqa: E402

MACHINES = ('gcc_x86_32', 'gcc_x86_16', 'ppc_32')
JOBS = 2
FOLDER = os.path.join(ROOT, 'build-proof')
LIMIT_S = 1800  # for one run of Frama-C, by the clock
OPTIONS = ('-eva-precision 3 -eva-auto-loop-unroll 300 -warn-signed-overflow -warn-signed-downcast '
           '-warn-right-shift-negative -warn-left-shift-negative -warn-invalid-pointer '
           '-kernel-warn-key typing:implicit-conv-void-ptr=inactive '  # which C has and C++ has not
           '-eva-msg-key=-initial-state,-final-states').split()
GOOD = ('Valid', 'Considered valid')
HEAD = re.compile(r'^ \* (proves|with|options|unreached|volatile|quick): *(.*(?:\n \*   +.*)*)', re.M)
# stands beside the alarm whose one side it is
DEAD = re.compile(r'^\[kernel\] .*: Warning: *\n +all target addresses were invalid.*\n', re.M)
COVERED = re.compile(r'^ *(\w+): (\d+) stmts out of (\d+)', re.M)


class Bad(Exception):
    """A call, or a harness, that cannot be carried out."""


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


class Harness:
    def __init__(self, path, root=ROOT):
        self.root, self.path = root, path
        self.name = os.path.relpath(path, os.path.join(root, 'tests', 'verify', 'proof'))[:-2]
        head = {key: re.sub(r'\n \*', ' ', value).split() for key, value in HEAD.findall(read(path))}
        self.proves = self.files(head.get('proves', ()))
        self.sources = list(dict.fromkeys(self.proves + self.files(head.get('with', ()))))
        self.options = head.get('options', [])
        self.unreached = head.get('unreached', [])
        self.is_volatile = head.get('volatile') == ['kept']
        self.quick = head.get('quick') != ['no']

    def files(self, patterns):
        files = []
        for pattern in patterns:
            found = sorted(glob.glob(os.path.join(self.root, pattern)))
            if not found:
                raise Bad(f'{self.name}: no {pattern}')
            files += found
        return files

    def inlined(self):
        """What stands where it is called, and nowhere else."""
        return [name for option, names in zip(self.options, self.options[1:]) if option == '-inline-calls'
                for name in names.split(',')]

    def functions(self):
        """All that are defined in what it proves."""
        names = []
        for path in self.proves:
            text = read(path)
            names += [name for name, _, _ in c_text.functions(text, c_text.tokens(text))]
        return names


def harnesses(root=ROOT):
    paths = sorted(glob.glob(os.path.join(root, 'tests', 'verify', 'proof', '*', '*.c')))
    return [Harness(path, root) for path in paths if re.search(r'^ \* proves: ', read(path), re.M)]


class Result:
    """What one run of Frama-C found."""

    def __init__(self, harness, machine):
        self.name, self.machine = harness.name, machine
        self.alarms, self.wrong = [], []  # what makes the result worthless
        self.is_broken = False
        self.reached = self.statements = 0
        self.seconds = 0.0  # of one core


class Alarm:
    def __init__(self, row, root):
        self.file = os.path.relpath(os.path.join(root, row['directory'], row['file']), root)
        self.is_dead = row['status'] == 'Dead'
        self.key = self.file, row['function'], f"{row['property kind']}: {row['property']}"
        self.text = f"{self.file}:{row['line']}: {row['function']}: {self.key[2]} ({row['status'].lower()})"

    def is_argued(self):
        return self.key in remaining.ARGUED


def look_at_alarms(result, harness, path):
    """All that is not proved. What is asserted where nothing comes is a fault of the harness itself; of a file that
    several include, it is of another's."""
    with open(path, encoding='utf-8', newline='') as file:
        rows = [row for row in csv.DictReader(file, delimiter='\t', quoting=csv.QUOTE_NONE)
                if row['status'] not in GOOD and not row['directory'].startswith('FRAMAC_SHARE')]
    alarms = [Alarm(row, harness.root) for row in rows]
    own = os.path.relpath(harness.path, harness.root)
    result.alarms = [alarm for alarm in alarms if not alarm.is_dead or alarm.file == own]


def look_at_coverage(result, harness, log):
    """Every function is to be reached. Of functions with one name all but one get a number from Frama-C."""
    covered = {name: (int(reached), int(of)) for name, reached, of in COVERED.findall(log)}
    defined = set(re.findall(r'(\w+) (?:\(address taken\) )?\(\d+ calls?\)', ' '.join(log.split())))
    own = set(harness.functions())
    for name in sorted(defined):
        if (re.sub(r'_\d+$', '', name) not in own and name not in own) or name in harness.inlined():
            continue
        reached, of = covered.get(name, (0, 0))
        result.reached += reached
        result.statements += of
        if reached == 0 and name not in harness.unreached:
            result.wrong.append(f'{name} is never reached')
        if reached != 0 and name in harness.unreached:
            result.wrong.append(f'{name} is reached, but `unreached:` names it')
        missed, _ = remaining.UNREACHED.get((harness.name, name), (0, ''))
        if reached != 0 and of - reached != missed:
            result.wrong.append(f'{name}: {of - reached} of {of} statements are never reached, and UNREACHED of '
                                f'remaining.py explains {missed}')
    explained = {name for of_harness, name in remaining.UNREACHED if of_harness == harness.name}
    result.wrong += [f'{name} is not there' for name in sorted((own | explained) - defined)]


def run(harness, machine, folder):
    result = Result(harness, machine)
    os.makedirs(folder, exist_ok=True)
    stem = os.path.join(folder, f'{harness.name.replace("/", "-")}-{machine}')
    table, log, spent = stem + '.csv', stem + '.log', stem + '.time'
    for path in (table, log, spent):
        if os.path.exists(path):
            os.remove(path)
    include = ' '.join(f'-I{os.path.join(harness.root, each)}' for each in ('include', 'src', 'tests/verify/proof'))
    if not harness.is_volatile:
        include += ' -Dvolatile='
    words = ['frama-c', '-no-unicode', '-time', spent, '-machdep', machine, f'-cpp-extra-args={include}', harness.path,
             *harness.sources, '-eva', *OPTIONS, *harness.options, '-then', '-report-csv', table, '-metrics',
             '-metrics-eva-cover']
    with open(log, 'w', encoding='utf-8') as out:
        try:
            status = subprocess.run(words, cwd=harness.root, env={**os.environ, 'PWD': harness.root}, stdout=out,
                                    stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=LIMIT_S,
                                    check=False).returncode
        except subprocess.TimeoutExpired:
            status = f'after {LIMIT_S} s'
    text = read(log)
    if status != 0 or not os.path.exists(table):
        result.is_broken = True
        result.wrong.append(f'frama-c ended with {status}: {log}')
        return result
    result.seconds = float(read(spent).split()[-1])
    look_at_alarms(result, harness, table)
    look_at_coverage(result, harness, text)
    # What is no alarm and is warned of may make the result worthless: a function without a body, a call not understood.
    text = DEAD.sub('', text)
    result.wrong += [line for line in text.splitlines() if 'Warning:' in line and not line.startswith('[eva:alarm]')]
    return result


def run_all(jobs, folder):
    """[(harness, machine)]: their results, in this order, as they come."""
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        yield from pool.map(lambda job: run(*job, folder), jobs)


def judge(result):
    """Returns what is wrong with a result."""
    return [alarm.text for alarm in result.alarms if not alarm.is_argued()] + result.wrong


def struck(results):
    """What is argued and does not come any more."""
    seen = {alarm.key for result in results for alarm in result.alarms}
    return [f'remaining.py: it is proved now: {", ".join(key)}' for key in remaining.ARGUED if key not in seen]


def unproved(chosen):
    """What is wrong with the sources of src/ that no harness proves: each is to be one that remaining.py names."""
    proved = {os.path.relpath(path, ROOT) for each in chosen for path in each.proves}
    there = glob.glob(os.path.join(ROOT, 'src', '**', '*.c'), recursive=True)
    sources = {os.path.relpath(path, ROOT) for path in there}
    named = set(remaining.UNPROVED)
    return [f'{path}: no harness proves it' for path in sorted(sources - proved - named)] + \
           [f'remaining.py: {path} is proved now, or not there' for path in sorted(named - (sources - proved))]


def prove(options):
    chosen = [each for each in harnesses() if not options.names or any(name in each.name for name in options.names)]
    machines = options.machine or (MACHINES[:1] if options.quick else MACHINES)
    jobs = [(each, machine) for each in chosen for machine in machines if each.quick or not options.quick]
    if not jobs:
        raise Bad('no such harness')
    results, failed = [], 0
    for result in run_all(jobs, FOLDER):
        results.append(result)
        wrong = judge(result)
        failed += bool(wrong)
        print(f'{result.name} {result.machine}: {len(result.alarms)} alarms, {result.reached} of '
              f'{result.statements} statements, {result.seconds:.0f} s{": FAILED" if wrong else ""}')
        print(''.join(f'    {line}\n' for line in wrong), end='', flush=True)
    missing = [] if options.names else unproved(chosen)
    if not (options.names or options.quick or options.machine):
        missing += struck(results)
    print(''.join(f'{line}: FAILED\n' for line in missing), end='')
    failed += len(missing)
    print(f'{sum(len(each.alarms) for each in results)} alarms, {sum(each.reached for each in results)} of '
          f'{sum(each.statements for each in results)} statements reached, {len(remaining.ARGUED)} alarms argued, '
          f'{len(remaining.UNPROVED)} sources not proved')
    print(f'{len(results) + len(missing) - failed} passed, {failed} failed')
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--quick', action='store_true')
    parser.add_argument('--machine', action='append', choices=MACHINES)
    parser.add_argument('--list', action='store_true')
    parser.add_argument('names', nargs='*')
    options = parser.parse_args()
    try:
        if shutil.which('frama-c') is None:
            raise Bad('frama-c is missing: apt-get install frama-c-base')
        if options.list:
            print('\n'.join(each.name for each in harnesses()))
            return 0
        return 1 if prove(options) else 0
    except Bad as error:
        print(f'eva.py: {error}', file=sys.stderr)
        return 1


if __name__ == '__main__':
    sys.exit(main())
