#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""cppcheck's addon for MISRA C:2012 finds, in the library and in the ports for microcontrollers, no deviation from a
mandatory rule or from a rule that is kept, and MISRA.md has the reason for each other rule that is broken.

    misra.py               compares the places with MISRA.md
    misra.py --list RULE   prints the places of a rule

The addon runs on dumps of its own, since cppcheck shows only one finding of the addon in a line."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from common import ROOT, files, read

ADDON = '/usr/lib/x86_64-linux-gnu/cppcheck/addons/misra.py'
PAGE = 'tests/checks/MISRA.md'

# What is one program, and what it takes to be read: the rules about names see each for itself.
PROGRAMS = {'src': [], 'port/avr': ['-DF_CPU=16000000UL'], 'port/rp2040': [], 'port/stm32f4': []}
JUDGED = re.compile(r'^(src|include|port/(avr|rp2040|stm32f4|serial))/')
BATCH = 6

# Of the mandatory rules the addon sees those that need no more than the syntax.
MANDATORY = {'9.1', '12.5', '13.6', '17.4', '17.6', '19.1', '21.13', '21.17', '21.18', '21.19', '21.20',
             '22.2', '22.4', '22.5', '22.6'}
KEPT = {'7.3', '12.1', '12.3', '13.3', '13.4', '16.3', '17.7'}  # more are; these took work

ENTRY = re.compile(r'^\* \*\*(\d+\.\d+)\*\* \((advisory|required)\)(.*?)(?=^\* |^#|\Z)', re.M | re.S)


def called(command, root):
    done = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f'{command[0]} failed: {done.stdout}{done.stderr}')
    return done.stdout


def addon(root, dumps):
    return [json.loads(line) for line in called([sys.executable, ADDON, '--cli', *dumps], root).splitlines()]


def look(job):
    """What the addon says of some files of a program."""
    root, program, paths = job
    include = ['-Iinclude', '-Iport', '-Iport/serial', f'-I{program}', *PROGRAMS[program]]
    called(['cppcheck', '--quiet', '--dump', '--std=c99', '-U__cplusplus', '--suppress=missingIncludeSystem', *include,
            *paths], root)
    # It goes on silently where an #error or a macro that it does not know has ended a file.
    for path in paths:
        if '<token ' not in read(root, f'{path}.dump'):
            raise SystemExit(f'misra.py: cppcheck has read nothing of {path}')
    # One at a time: of several, it keeps the names of the first alone for the rules that compare files.
    return [finding for path in paths for finding in addon(root, [f'{path}.dump'])]


def places(root):
    """(rule, file, line, column) of each place. root is written to."""
    jobs = []
    for program in PROGRAMS:
        paths = files(root, program, ends='.c')
        jobs += [(root, program, paths[at:at + BATCH]) for at in range(0, len(paths), BATCH)]
    if not jobs:
        raise SystemExit('misra.py: no file to look at')
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = [finding for said in pool.map(look, jobs) for finding in said]
        names = [files(root, program, ends='.ctu-info') for program in PROGRAMS]
        for said in pool.map(lambda paths: addon(root, paths), filter(None, names)):
            found += said
    return sorted({(finding['errorId'].replace('c2012-', ''), os.path.normpath(finding['file']), finding['linenr'],
                    finding['column'])
                   for finding in found if 'errorId' in finding and JUDGED.match(os.path.normpath(finding['file']))})


def of(rule):
    return [int(part) for part in rule.split('.')]


def compared(found, text):
    """Yields the deviations that `text`, the page, does not allow, and what the page lists for nothing."""
    named = {entry[1] for entry in ENTRY.finditer(text)}
    broken = {rule for rule, _, _, _ in found}
    for rule, path, line, column in found:
        if rule in MANDATORY | KEPT:
            yield f'{path}:{line}:{column}: rule {rule}, which is kept'
        elif rule not in named:
            yield f'{path}:{line}:{column}: rule {rule}, and MISRA.md has no reason for it'
    yield from (f'MISRA.md: rule {rule} is not broken' for rule in sorted(named - broken, key=of))
    yield from (f'MISRA.md: rule {rule} is kept and not in the list' for rule in sorted(KEPT, key=of)
                if not re.search(rf'^\* {re.escape(rule)} ', text, re.M))


def copied(folder):
    for name in ('src', 'include', 'port'):
        shutil.copytree(os.path.join(ROOT, name), os.path.join(folder, name))


def main(arguments):
    with tempfile.TemporaryDirectory() as copy:
        copied(copy)
        found = places(copy)
    if arguments[:1] == ['--list']:
        for rule, path, line, column in found:
            if rule in arguments[1:]:
                print(f'{path}:{line}:{column}: {rule}: {read(ROOT, path).splitlines()[line - 1].strip()}')
        return 0
    problems = list(compared(found, read(ROOT, PAGE)))
    for rule, count in sorted(Counter(rule for rule, _, _, _ in found).items(), key=lambda item: of(item[0])):
        print(f'{rule:>5} {count:4}')
    print(*problems, f'{len(problems)} problems', sep='\n')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
