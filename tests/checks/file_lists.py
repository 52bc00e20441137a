#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""include/README.md's lists of the files of src/ that a program has to compile: for each driver, and for what may be
named beside it. They are what the linker takes from an archive, by its map, for the programs of tests/bench/sizes; so a
program that compiles them and no others links, also without --gc-sections.

    file_lists.py             fails unless the page has what the linker takes
    file_lists.py --update    writes it"""
import os
import re
import sys
import tempfile

from common import ROOT, files, main, read, run
from linked import PROGRAMS, REGISTERS, TARGETS, Library

PAGE = 'include/README.md'
TABLE = r'(?s)(?<=<!-- {}: kept by tests/checks/file_lists.py --update -->\n).*?(?=<!-- end -->)'
# What a program may name beside a driver that asks, HPS-167S for one: what that takes is given beside what both take.
BESIDE = {
    'fathom_line_find_echo': 'a line that finds its echo out',
    'fathom_line_marks': 'a line that uses the silence and the error flags of the port',
    'fathom_line_count': 'a line that counts',
    'fathom_line_senders': 'a line with devices that send unsolicited frames',
    'fathom_line_masters': 'a line that other masters use',
    'fathom_fair_share': 'the share of time instead of turns',
    'fathom_modbus_client_with_zero': 'a unit at address 0',
    'fathom_output_set_line_break': 'trigger or select by a break (`fathom_output_line_break`)',
    'fathom_contact_line_guard': 'a switch on the pins of a line',
    'fathom_edges_capture': 'pulses by a pin interrupt',
    'fathom_debounce_add_sample': 'a switch in software',
    'fathom_median_add_sample': 'a median that drops spikes',
    'fathom_alarm_add_sample': 'an alarm',
    'fathom_level_from_distance': "a tank's level",
    'fathom_model_a02yyuw': "the facts of a DYP module that is a relative of the A16",
    'fathom_model_hc_sr04': 'those of an HC-SR04, JSN-SR04T, AJ-SR04M',
    'fathom_model_find': 'the list of all models',
    'fathom_wait': 'the blocking form',
    'fathom_status_name': 'the names of errors',
    'fathom_status_advice': 'what to check after an error',
}
WITH = 'hps167s'
# Programs that are another one with one of these.
MORE = {'a16_auto_alarm', 'a16_auto_median', 'tank', 'tank_lying', 'tank_table'}


class Linker(Library):
    def __init__(self, root, work):
        _, prefix, flags = TARGETS[0]
        super().__init__(root, prefix, flags, work)
        self.names = {os.path.basename(self.object(path)): path for path in files(root, 'src', ends='.c')}

    def takes(self, program, *symbols):
        """The sources that the linker takes for a program that names these symbols, too."""
        wanted = os.path.join(self.work, program + '_wanted.o')
        image = os.path.join(self.work, program + '_alone')
        # First the program alone out of the file with its neighbours, then with the archive, nothing left out.
        for arguments in (['-r', '-Wl,--gc-sections', f'-DBEGIN={program}_begin', f'-DUSE={program}_use',
                           os.path.join(PROGRAMS, 'sizes', 'main.c'), *map(self.object, self.programs), '-o', wanted],
                          [f'-Wl,-Map,{image}.map', *(f'-Wl,--require-defined={symbol}' for symbol in symbols),
                           wanted, self.archive, '-lgcc', '-o', image]):
            good, said = run([*self.compiler, '-nostdlib', '-nostartfiles', '-Wl,-e,main', *REGISTERS, *arguments],
                             self.root)
            if not good:
                self.problems.append(f'{PAGE}: {program} does not link:\n{said}')
                return set()
        with open(image + '.map', encoding='utf-8') as file:
            members = re.findall(r'libfathom\.a\((\w+\.o)\)', file.read())
        return {self.names[member] for member in members}


def listed(sources):
    """By folder, as a Makefile or a shell takes it from src/."""
    return '`' + ' '.join(os.path.relpath(path, 'src') for path in sorted(sources)) + '`'


def tables(linker):
    programs = re.findall(r'^ +X\((\w+)\)', read(ROOT, 'tests/bench/sizes/programs.h'), re.M)
    drivers = ['| a program that reads | in `src/` |', '|---|---|']
    drivers += [f'| `{program}` | {listed(linker.takes(program))} |' for program in programs if program not in MORE]
    base = linker.takes(WITH)
    beside = ['| names | for | more of `src/` |', '|---|---|---|']
    for symbol, what in BESIDE.items():
        more = linker.takes(WITH, symbol) - base
        beside.append(f'| `{symbol}` | {what} | {listed(more) if more else "nothing"} |')
    return {'drivers': '\n'.join(drivers) + '\n', 'beside': '\n'.join(beside) + '\n'}


def made(root):
    """(tables, problems)"""
    with tempfile.TemporaryDirectory() as work:
        linker = Linker(root, work)
        return (tables(linker) if not linker.problems else {}), linker.problems


def check(root):
    wanted, problems = made(root)
    page = read(root, PAGE)
    for name, table in wanted.items():
        found = re.findall(TABLE.format(name), page)
        if len(found) != 1:
            problems.append(f'{PAGE}: no table {name}')
            continue
        has, right = set(found[0].splitlines()), set(table.splitlines())
        problems += [f'{PAGE}: the linker does not say {line}' for line in has - right]
        problems += [f'{PAGE}: the linker says {line}' for line in right - has]
        if not problems and found[0] != table:
            problems.append(f'{PAGE}: the rows of the table {name} are in another order')
    return problems


def update():
    wanted, problems = made(ROOT)
    text = read(ROOT, PAGE)
    for name, table in wanted.items():
        text = re.sub(TABLE.format(name), lambda _, table=table: table, text, count=1)
    with open(os.path.join(ROOT, PAGE), 'w', encoding='utf-8') as file:
        file.write(text)
    print('\n'.join(problems), end='')
    return 1 if problems else 0


if __name__ == '__main__':
    if sys.argv[1:] == ['--update']:
        sys.exit(update())
    main(check)
