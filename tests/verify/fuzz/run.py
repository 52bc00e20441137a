#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Gives the library, the port over libmodbus and the tool inputs that no test has, with libFuzzer.

    run.py [--seconds S] [TARGET ...]   each target for so long (10), two at once
    run.py --full [--runs N] [--update] 10^8 (N) executions over all targets, against figures.csv; --update keeps it
    run.py --self-test [TARGET ...]     plants faults (faults.py), each of which its target has to find
    run.py --input FILE TARGET          one input: of found/ (hex), or what a crash has left in build-fuzz

The last line is "N passed, M failed"."""
import argparse
import concurrent.futures
import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import build
import faults
import seeds
from targets import TARGETS

FIGURES = os.path.join(build.HERE, 'figures.csv')
FULL = 10 ** 8
SEED = 20261123
# The search depends a little on what the heap's addresses are: so much of the edges may be missing.
LOST = 0.02


def named(names):
    known = {target.name: target for target in TARGETS}
    for name in names:
        if name not in known:
            sys.exit(f'there is no target {name!r}, only {", ".join(known)}')
    return [known[name] for name in names] or TARGETS


def work_folder(target):
    return os.path.join(build.FOLDER, 'work', target.name)


def seed_folder(target, frames):
    folder = os.path.join(build.FOLDER, 'seeds', target.name)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for index, seed in enumerate(seeds.of(target.name, frames)):
        with open(os.path.join(folder, f'{index:03}'), 'wb') as file:
            file.write(seed)
    return folder


def hex_of(path):
    with open(path, encoding='utf-8') as file:
        return bytes.fromhex(re.sub(r'#[^\n]*|\s', '', file.read()))


class Outcome:
    """What one run of libFuzzer has told."""

    def __init__(self, target, text, status, seconds):
        self.target, self.text, self.status, self.seconds = target, text, status, seconds
        runs = re.findall(r'stat::number_of_executed_units: (\d+)', text)
        edges = re.findall(r' cov: (\d+)', text)
        self.runs = int(runs[-1]) if runs else 0
        self.edges = int(edges[-1]) if edges else 0
        # The last line of `times`: of the children. A busy machine is slow, not idle.
        spent = re.findall(r'^(\d+)m([\d.]+)s (\d+)m([\d.]+)s$', text, re.M) or [(0, 0, 0, 0)]
        minutes, seconds, *system = map(float, spent[-1])
        self.cpu = 60 * (minutes + system[0]) + seconds + system[1]
        self.is_clean = status == 0

    def why(self):
        """The line that says what was wrong."""
        found = re.search(r'(broken promise: .*|runtime error: .*|ERROR: (?:Address|Leak)Sanitizer: \S+|'
                          r'ERROR: libFuzzer: .*)', self.text)
        return found[0] if found else self.text[-300:]

    def tell(self):
        crash = re.findall(r'Test unit written to (\S+)', self.text)
        print(f'{self.target.name}: {self.why()}')
        for line in re.findall(r'^ +#\d+ .* in [a-z]\w* .*$', self.text, re.M)[:12]:
            print(line)
        if not crash:
            print(self.text[-2000:])
            return
        with open(crash[-1], 'rb') as file:
            print(f'the input, in hex: {file.read().hex()}')
        print(f'again: tests/verify/fuzz/run.py --input {os.path.relpath(crash[-1], build.ROOT)} {self.target.name}')


def fuzz(target, program, folders, limit, limit_s, work=None):
    """One run; limit: options of libFuzzer that end it."""
    work = work or work_folder(target)
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    began = time.monotonic()
    seeds_list = os.path.join(work, 'seeds')
    with open(seeds_list, 'w', encoding='utf-8') as file:
        file.write(','.join(os.path.join(folder, name) for folder in folders for name in sorted(os.listdir(folder))))
    # Weights, where the target is slow, and no folder for what is found: else two thirds of the time go there.
    command = ['sh', '-c', '"$@"; status=$?; times; exit $status', 'sh',
               program, f'-seed={SEED}', f'-max_len={target.longest}', '-len_control=20', '-timeout=10',
               f'-entropic={int(target.is_weighted)}',
               '-rss_limit_mb=2048', '-print_final_stats=1', '-detect_leaks=0', f'-artifact_prefix={work}/',
               f'-seed_inputs=@{seeds_list}', *limit]
    environment = {**os.environ, 'UBSAN_OPTIONS': 'print_stacktrace=1', 'ASAN_OPTIONS': 'detect_leaks=0'}
    with subprocess.Popen(command, cwd=work, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, start_new_session=True) as process:
        try:
            text = process.communicate(timeout=limit_s)[0].decode(errors='replace')
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            text = process.communicate()[0].decode(errors='replace') + '\nit does not end'
        status = process.returncode
    return Outcome(target, text, status, time.monotonic() - began)


def found_folder(target):
    """What was found once, as bytes."""
    folder = os.path.join(build.FOLDER, 'found', target.name)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    where = os.path.join(build.HERE, 'found')
    for name in sorted(os.listdir(where)):
        if name.endswith('.txt') and name.split('-')[0] == target.name:
            with open(os.path.join(folder, name), 'wb') as file:
                file.write(hex_of(os.path.join(where, name)))
    return folder


def run_all(targets, frames, limit_of):
    """(target, outcome) as they end, two at once; the longest begin first."""
    folders = {target.name: [seed_folder(target, frames), found_folder(target)] for target in targets}
    with concurrent.futures.ThreadPoolExecutor(build.JOBS) as pool:
        begun = [pool.submit(fuzz, target, target.program(), folders[target.name], *limit_of(target))
                 for target in targets]
        for future in concurrent.futures.as_completed(begun):
            yield future.result()


def show(outcome, problem):
    print(f'{outcome.target.name:12} {outcome.runs:10} executions {outcome.edges:6} edges '
          f'{outcome.cpu:7.1f} s of a core {outcome.runs / max(outcome.cpu, 0.001):9.0f}/s  {problem}', flush=True)


def quick(targets, frames, seconds):
    failed = 0
    for outcome in run_all(targets, frames, lambda target: ([f'-max_total_time={seconds}'], seconds + 60)):
        problem = '' if outcome.is_clean else 'a finding'
        if outcome.is_clean and outcome.runs < outcome.target.least * outcome.cpu:
            problem = f'it sat idle: less than {outcome.target.least} a second'
        show(outcome, problem)
        if not outcome.is_clean:
            outcome.tell()
        failed += problem != ''
    return len(targets) - failed, failed


def kept_figures():
    if not os.path.exists(FIGURES):
        return {}
    with open(FIGURES, encoding='ascii', newline='') as file:
        return {row['target']: row for row in csv.DictReader(file)}


def full(targets, frames, runs, update):
    kept, fresh, failed = kept_figures(), {}, 0
    shares = sum(target.share for target in TARGETS)
    total = 0
    for outcome in run_all(targets, frames,
                           lambda target: ([f'-runs={runs * target.share // shares}'], 4 * 3600)):
        target, problem = outcome.target, ''
        wanted = runs * target.share // shares
        before = kept.get(target.name)
        if not outcome.is_clean:
            problem = 'a finding'
        elif outcome.runs < wanted:
            problem = f'{wanted} were wanted'
        elif before is None:
            problem = '' if update else 'it has no row in figures.csv'
        elif wanted >= int(before['executions']) and outcome.edges < int(before['edges']) * (1 - LOST):
            problem = f'{before["edges"]} edges before'
        show(outcome, problem)
        if not outcome.is_clean:
            outcome.tell()
        failed += problem != ''
        total += outcome.runs
        if not problem:
            fresh[target.name] = {'target': target.name, 'executions': wanted, 'edges': outcome.edges}
    print(f'{total} executions over all')
    if update:
        with open(FIGURES, 'w', encoding='ascii', newline='') as file:
            writer = csv.DictWriter(file, ['target', 'executions', 'edges'], lineterminator='\n')
            writer.writeheader()
            writer.writerows(row for _, row in sorted({**kept, **fresh}.items()))
    return len(targets) - failed, failed


def self_test(targets, frames):
    """Each fault, planted alone, is found in its time."""
    known = {target.name: target for target in targets}
    chosen = [fault for fault in faults.FAULTS if fault.target in known]

    def attempt(fault):
        target = known[fault.target]
        with tempfile.TemporaryDirectory(prefix='planted.', dir=build.FOLDER) as folder:
            text = os.path.join(folder, os.path.basename(fault.file))
            planted = os.path.join(folder, 'planted.o')
            with open(os.path.join(build.ROOT, fault.file), encoding='utf-8') as file:
                original = file.read()
            if original.count(fault.old) != 1:
                return fault, None, f'{fault.old!r} is not in {fault.file} exactly once'
            with open(text, 'w', encoding='utf-8') as file:
                file.write(original.replace(fault.old, fault.new))
            build.compile_one(fault.file, planted, text)
            objects = [planted if one == fault.file else build.object_of(one) for one in target.all_sources()]
            if planted not in objects:
                return fault, None, f'{fault.file} is no part of {target.name}'
            program = os.path.join(folder, 'fuzz')
            build.link(target, objects, program)
            outcome = fuzz(target, program, [os.path.join(build.FOLDER, 'seeds', target.name)],
                           [f'-max_total_time={fault.seconds}'], fault.seconds + 60,
                           os.path.join(folder, 'work'))
            return fault, outcome, '' if not outcome.is_clean else f'not found in {outcome.runs} executions'

    failed = 0
    for target in targets:
        seed_folder(target, frames)
    with concurrent.futures.ThreadPoolExecutor(build.JOBS) as pool:
        for fault, outcome, problem in pool.map(attempt, chosen):
            if not problem and fault.says not in outcome.why():
                problem = f'found by something else: {outcome.why()}'
            print(f'{fault.file} {fault.new.strip()!r}: ' +
                  (problem or f'found by {fault.target} in {outcome.seconds:.1f} s: {outcome.why()}'), flush=True)
            failed += problem != ''
    return len(chosen) - failed, failed


def one_input(path, target):
    with tempfile.NamedTemporaryFile() as file:
        with open(path, 'rb') as source:
            file.write(hex_of(path) if path.endswith('.txt') else source.read())
        file.flush()
        status = subprocess.run([target.program(), file.name], check=False).returncode
    return (1, 0) if status == 0 else (0, 1)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--seconds', type=int, default=10)
    parser.add_argument('--full', action='store_true')
    parser.add_argument('--runs', type=int, default=FULL)
    parser.add_argument('--update', action='store_true')
    parser.add_argument('--self-test', action='store_true')
    parser.add_argument('--input')
    parser.add_argument('targets', nargs='*')
    options = parser.parse_args()
    for program in ('clang-14', 'ld'):
        if not shutil.which(program):
            sys.exit(f'{program} is missing\n0 passed, 1 failed')
    targets = named(options.targets)
    began = time.monotonic()
    try:
        frames = build.build(targets)
        print(f'built in {time.monotonic() - began:.0f} s', flush=True)
        if options.input:
            passed, failed = one_input(options.input, targets[0])
        elif options.self_test:
            passed, failed = self_test(targets, frames)
        elif options.full:
            passed, failed = full(targets, frames, options.runs, options.update)
        else:
            passed, failed = quick(targets, frames, options.seconds)
    except build.Failed as error:
        print(error)
        passed, failed = 0, 1
    print(f'{passed} passed, {failed} failed')
    sys.exit(1 if failed else 0)


main()
