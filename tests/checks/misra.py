#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""MISRA C:2012 by cppcheck's addon, over the library and the ports for microcontrollers: no place more than misra.csv
has for each rule and file, none at all of a mandatory rule or of one that is kept, and a paragraph in MISRA.md for each
rule that is broken.

    misra.py                     compares; fewer places than in misra.csv are told
    misra.py --update [RULE ...]  writes the fewer places there, and for the rules named also the more
    misra.py --list RULE         prints the places of a rule
    misra.py --self-test

The addon is run on dumps of its own: cppcheck shows but one finding of it in a line."""
import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from common import ROOT, files, plant, read

ADDON = '/usr/lib/x86_64-linux-gnu/cppcheck/addons/misra.py'
TABLE = os.path.join(ROOT, 'tests', 'checks', 'misra.csv')
PAGE = os.path.join(ROOT, 'tests', 'checks', 'MISRA.md')

# What is one program, and what it takes to be read: the rules about names see each for itself.
PROGRAMS = {'src': [], 'port/avr': ['-DF_CPU=16000000UL'], 'port/rp2040': [], 'port/stm32f4': []}
COUNTED = re.compile(r'^(src|include|port/(avr|rp2040|stm32f4|serial))/')
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
    return addon(root, [f'{path}.dump' for path in paths])


def places(root, only=None):
    """(rule, file, line, column) of each place. root is written to; only: these files alone."""
    jobs = []
    for program in PROGRAMS:
        paths = [path for path in files(root, program, ends='.c') if only is None or path in only]
        jobs += [(root, program, paths[at:at + BATCH]) for at in range(0, len(paths), BATCH)]
    if not jobs:
        raise SystemExit('misra.py: no file to look at')
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = [finding for said in pool.map(look, jobs) for finding in said]
        if only is None:
            names = [[path for path in files(root, program, ends='.ctu-info')] for program in PROGRAMS]
            for said in pool.map(lambda paths: addon(root, paths), filter(None, names)):
                found += said
    return sorted({(finding['errorId'].replace('c2012-', ''), os.path.normpath(finding['file']), finding['linenr'],
                    finding['column'])
                   for finding in found if 'errorId' in finding and COUNTED.match(os.path.normpath(finding['file']))})


def of(rule):
    return [int(part) for part in rule.split('.')]


def kept_table():
    with open(TABLE, encoding='ascii', newline='') as file:
        return {(row['rule'], row['file']): int(row['places']) for row in csv.DictReader(file)}


def write_table(counts):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(('rule', 'file', 'places'))
    for rule, path in sorted(counts, key=lambda key: (of(key[0]), key[1])):
        writer.writerow((rule, path, counts[rule, path]))
    with open(TABLE, 'w', encoding='ascii') as file:
        file.write(text.getvalue())


def compared(found, table):
    """Problems: what there is more of than in the table, and what may not be at all."""
    counts = Counter((rule, path) for rule, path, _, _ in found)
    for rule, path, line, column in found:
        if rule in MANDATORY | KEPT:
            yield f'{path}:{line}:{column}: rule {rule}, which is kept'
    for (rule, path), count in sorted(counts.items()):
        if rule not in MANDATORY | KEPT and count > table.get((rule, path), 0):
            lines = ', '.join(str(line) for other, where, line, _ in found if (other, where) == (rule, path))
            yield (f'{path}: {count} places of rule {rule}, and misra.csv has {table.get((rule, path), 0)}: '
                   f'lines {lines}')


def page_problems(text, table):
    """A paragraph for each rule of the table and for no other; the file that it names first breaks the rule."""
    entries = {found[1]: found[3] for found in ENTRY.finditer(text)}
    broken = {rule for rule, _ in table}
    for rule in sorted(broken - set(entries), key=of):
        yield f'MISRA.md: no paragraph for rule {rule}, which is broken'
    yield from (f'MISRA.md: rule {rule} is not broken' for rule in sorted(set(entries) - broken, key=of))
    yield from (f'misra.csv: rule {rule} may have no place' for rule in sorted(broken & (MANDATORY | KEPT), key=of))
    yield from (f'MISRA.md: rule {rule} is kept and not in the list' for rule in sorted(KEPT, key=of)
                if not re.search(rf'^\* {re.escape(rule)} ', text, re.M))
    for rule in sorted(broken & set(entries), key=of):
        named = re.search(r'`((?:src|include|port)/[\w./]+)`', entries[rule])
        if named is None or (rule, named[1]) not in table:
            yield f'MISRA.md: the paragraph for rule {rule} names no file with a place of it'


def copied(folder):
    for name in ('src', 'include', 'port'):
        shutil.copytree(os.path.join(ROOT, name), os.path.join(folder, name))


RETURN = 'int fathom_x(int n);\nint fathom_x(int n) '
FAULTS = [  # a file, old text (None: the end), new text, what has to be said of it
    ('src/codec/crc16.c', '(crc >> 8) ^ table', 'crc >> 8 ^ table', 'rule 12.1, which is kept'),
    ('src/codec/crc16.c', ') & 0xFFu', ') & 0xFF', 'places of rule 10.4'),
    ('src/engine/line.c', '(void)fathom_line_look', 'fathom_line_look', 'rule 17.7, which is kept'),
    ('src/codec/crc16.c', '*bytes) & 0xFFu];\n        bytes++;', '*bytes++) & 0xFFu];', 'rule 13.3, which is kept'),
    ('src/sensor/hps167s_settings.c', 'value);\n        break;\n    }', 'value);\n    }', 'rule 16.3, which is kept'),
    ('src/engine/line.c', None, RETURN + '{ return (int)sizeof(n++); }\n', 'rule 13.6, which is kept'),
    ('src/engine/line.c', None, RETURN + '{ if (n == 1) return 2; return 3; }\n', 'places of rule 15.5'),
    ('src/engine/line.c', None, RETURN + '{ goto end; end: return n; }\n', 'places of rule 15.1'),
    ('port/rp2040/uart.c', 'bytes[n] = (uint8_t)entry;\n        n++;', 'bytes[n++] = (uint8_t)entry;',
     'rule 13.3, which is kept'),
    ('port/avr/usart0.c', None, RETURN + '{ return n & 1 | 2; }\n', 'rule 12.1, which is kept'),
]
PAGE_FAULTS = [  # old text and new text of the page, what has to be said
    ('* **15.5** (advisory)', '* 15.5 (advisory)', 'no paragraph for rule 15.5'),
    ('* **15.5** (advisory)', '* **15.1** (advisory)', 'rule 15.1 is not broken'),
    ('\n* 17.7 ', '\n17.7 ', 'rule 17.7 is kept and not in the list'),
    ('`src/codec/crc16.c`', '`src/codec/hps167s_registers.c`', 'names no file'),
]


def self_test():
    table, text, missed = kept_table(), read(ROOT, 'tests/checks/MISRA.md'), 0
    for path, old, new, words in FAULTS:
        with tempfile.TemporaryDirectory() as copy:
            copied(copy)
            before = list(compared(places(copy, [path]), table))
            plant(copy, path, old, new)
            said = compared(places(copy, [path]), table)
            if before or not any(words in problem and path in problem for problem in said):
                print(f'not found: {new.strip()!r} in {path} ({words})', *before)
                missed += 1
    for old, new, words in PAGE_FAULTS:
        if old not in text:
            raise SystemExit(f'self-test: {old!r} is not in MISRA.md')
        if not any(words in problem for problem in page_problems(text.replace(old, new), table)):
            print(f'not found: {new!r} in MISRA.md ({words})')
            missed += 1
    # A mandatory rule has no place, whatever the table says.
    mandatory = {**table, ('17.4', 'src/engine/line.c'): 1}
    if not any('may have no place' in problem for problem in page_problems(text, mandatory)):
        print('not found: a mandatory rule in the table')
        missed += 1
    count = len(FAULTS) + len(PAGE_FAULTS) + 1
    print(f'{count} planted faults, {count - missed} found')
    return 1 if missed else 0


def main(arguments):
    if arguments == ['--self-test']:
        return self_test()
    with tempfile.TemporaryDirectory() as copy:
        copied(copy)
        found = places(copy)
    if arguments[:1] == ['--list']:
        for rule, path, line, column in found:
            if rule in arguments[1:]:
                print(f'{path}:{line}:{column}: {rule}: {read(ROOT, path).splitlines()[line - 1].strip()}')
        return 0
    table = kept_table() if os.path.exists(TABLE) else {}
    counts = Counter((rule, path) for rule, path, _, _ in found)
    if arguments[:1] == ['--update']:
        table = {key: count if key[0] in arguments[1:] else min(count, table.get(key, 0))
                 for key, count in counts.items()}
        table = {key: count for key, count in table.items() if count != 0}
        write_table(table)
    problems = [*compared(found, table), *page_problems(read(ROOT, 'tests/checks/MISRA.md'), table)]
    for rule in sorted({rule for rule, _ in counts}, key=of):
        print(f'{rule:>5} {sum(count for (other, _), count in counts.items() if other == rule):4}')
    fewer = sum(max(0, count - counts[key]) for key, count in table.items())
    if fewer != 0:
        print(f'{fewer} places fewer than misra.csv has: misra.py --update')
    print(*problems, sep='\n', end='\n' if problems else '')
    print(f'{len(problems)} problems')
    return 1 if problems else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
