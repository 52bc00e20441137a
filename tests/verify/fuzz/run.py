#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Feeds the library, the port over libmodbus and the tool with inputs that no test has, by libFuzzer.

    run.py [--times N] [TARGET ...]   N (1) times the executions that targets.py has for each target, two at once
    run.py --full                     10^8 executions over all targets
    run.py --input FILE TARGET        one input: of found/ (hex), or what a crash has left in build-fuzz

A target fails on a finding and on fewer edges than targets.py has. It runs a number of inputs, not for a time, so a slow
machine tries as many.
The last line is "N passed, M failed"."""
import argparse
import concurrent.futures
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import build
import seeds
from targets import TARGETS

FULL = 10 ** 8
LIMIT_S = 4 * 3600
SEED = 20261123


def named(names):
    known = {target.name: target for target in TARGETS}
    for name in names:
        if name not in known:
            sys.exit(f'there is no target {name!r}, only {", ".join(known)}')
    return [known[name] for name in names] or TARGETS


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


def fuzz(target, program, folders, runs):
    """One run of so many executions."""
    work = os.path.join(build.FOLDER, 'work', target.name)
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    began = time.monotonic()
    seeds_list = os.path.join(work, 'seeds')
    with open(seeds_list, 'w', encoding='utf-8') as file:
        file.write(','.join(os.path.join(folder, name) for folder in folders for name in sorted(os.listdir(folder))))
    # Weights, where the target is slow, and no folder for what is found: else two thirds of the time go there.
    command = [program, f'-runs={runs}', f'-seed={SEED}', f'-max_len={target.longest}', '-len_control=20', '-timeout=30',
               f'-entropic={int(target.is_weighted)}',
               '-rss_limit_mb=2048', '-print_final_stats=1', '-detect_leaks=0', f'-artifact_prefix={work}/',
               f'-seed_inputs=@{seeds_list}']
    environment = {**os.environ, 'UBSAN_OPTIONS': 'print_stacktrace=1', 'ASAN_OPTIONS': 'detect_leaks=0'}
    with subprocess.Popen(command, cwd=work, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, start_new_session=True) as process:
        try:
            text = process.communicate(timeout=LIMIT_S)[0].decode(errors='replace')
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


def run_all(targets, frames, times):
    """(target, outcome) as they end, two at once."""
    folders = {target.name: [seed_folder(target, frames), found_folder(target)] for target in targets}
    with concurrent.futures.ThreadPoolExecutor(build.JOBS) as pool:
        begun = [pool.submit(fuzz, target, target.program(), folders[target.name], times * target.runs)
                 for target in targets]
        for future in concurrent.futures.as_completed(begun):
            yield future.result()


def judge(outcomes):
    """Returns how many of the outcomes passed and failed."""
    passed = failed = total = 0
    for outcome in outcomes:
        target, problem = outcome.target, ''
        if not outcome.is_clean:
            problem = 'a finding'
        elif outcome.edges < target.edges:
            problem = f'FAILED: fewer than {target.edges} edges'
        print(f'{target.name:12} {outcome.runs:10} executions {outcome.edges:6} edges {outcome.seconds:7.1f} s  {problem}',
              flush=True)
        if not outcome.is_clean:
            outcome.tell()
        passed, failed, total = passed + (not problem), failed + bool(problem), total + outcome.runs
    print(f'{total} executions over all')
    return passed, failed


def one_input(path, target):
    with tempfile.NamedTemporaryFile() as file:
        with open(path, 'rb') as source:
            file.write(hex_of(path) if path.endswith('.txt') else source.read())
        file.flush()
        status = subprocess.run([target.program(), file.name], check=False).returncode
    return (1, 0) if status == 0 else (0, 1)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--times', type=int, default=1)
    parser.add_argument('--full', action='store_true')
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
        else:
            times = math.ceil(FULL / sum(target.runs for target in TARGETS)) if options.full else options.times
            passed, failed = judge(run_all(targets, frames, times))
    except build.Failed as error:
        print(error)
        passed, failed = 0, 1
    print(f'{passed} passed, {failed} failed')
    sys.exit(1 if failed else 0)


main()
