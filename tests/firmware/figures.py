#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Figures that are measured on real images in simulators: cycles, bus time, stack, share of the processor.

    figures.py GROUP COMPILER PROGRAM [ARGUMENT ...]
                                 runs PROGRAM, whose lines "figure NAME VALUE UNIT" are GROUP's, and prints them
    figures.py --check ...       also fails if a figure is over that of the last release, by tests/support/bounds.py, or
                                 over its bound, or is not measured
    figures.py --update ...      for a release: also writes figures.csv; bounds stay, and are written there by hand
    figures.py --page            fails if the table of include/COST.md has other rows; with --update, writes the table

Less is better for all figures. The simulators are deterministic, so a figure is the same each time for one version of
the compiler, which the file names. With another version the figures are printed and not compared. This script fails if
PROGRAM does, and first prints the output of PROGRAM, so PROGRAM may be a test. COMPILER made the images.
"""
import argparse
import csv
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
FIGURES = os.path.join(HERE, 'figures.csv')
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(ROOT, 'include', 'COST.md')
TABLE = re.compile(
    r'(?s)(?<=<!-- firmware: kept by tests/firmware/figures.py --page --update -->\n).*?(?=<!-- end -->)')
KEPT = '# The figures of the last release. Only a release changes this file, by --update of tests/firmware/figures.py.'
LINE = re.compile(r'^figure (\w+) (-?\d+(?:\.\d+)?) (\S+)$', re.M)

sys.path.append(os.path.join(ROOT, 'tests', 'support'))
from bounds import judge, names_of

# The rows of the page: (figure, its name there)
IN_PAGE = [
    ('avr_receive_interrupt', 'ATmega328P: receive interrupt, and 4 more of entry'),
    ('avr_empty_interrupt', 'transmit buffer empty'),
    ('avr_transmit_interrupt', 'transmit complete, which drops driver-enable'),
    ('avr_overflow_interrupt', 'the clock'),
    ('avr_capture_interrupt', 'input capture, with a glitch'),
    ('avr_int0_interrupt', 'INT0'),
    ('avr_poll_shortest', '`fathom_line_poll` that finds nothing, on this port'),
    ('avr_poll_longest', '`fathom_line_poll`, the longest'),
    ('avr_crc_byte', 'a byte of CRC, without a table'),
    ('avr_crc_table_byte', 'a byte of CRC, with the table in program memory'),
    ('avr_share_9600', 'of the processor, while an HPS-167S is polled as often as 9600 baud allow'),
    ('avr_share_115200', 'the same at 115200 baud, 54 times a second'),
    ('avr_share_gathering_115200', 'the same, if bytes may gather for 1 ms'),
    ('avr_bus_hps167s_9600', 'bus time of an HPS-167S poll over what line and sensor allow, 9600 baud'),
    ('avr_bus_hps167s_115200', 'the same at 115200 baud'),
    ('avr_bus_a05_9600', 'the same of an A05, one probe, 9600 baud'),
    ('avr_bus_a05_115200', 'the same at 115200 baud'),
    ('avr_stack_hps167s_rs485', 'deepest stack of `hps167s_rs485`, interrupts included'),
    ('avr_first_flash', "the first page's program, with `snprintf`: flash"),
    ('avr_first_ram', 'its RAM, without the stack'),
    ('avr_first_bus_flash', 'of its flash what the bus costs over parts that are set up by hand'),
    ('avr_tank_flash', '`examples/avr/tank.c`: flash'),
    ('avr_tank_ram', 'its RAM, without the stack'),
    ('avr_tank_median', 'of its flash the functions of `median`'),
    ('avr_tank_level', 'of its flash those of `level` that it names'),
    ('avr_hps167s_flash_cpp_over_c', 'a program with a class of `fathom.hpp` over the same program in C: flash'),
    ('avr_hps167s_ram_cpp_over_c', 'the same: RAM'),
    ('m0_hps167s_flash_cpp_over_c', 'Cortex-M0+: the same: flash'),
    ('m0_hps167s_ram_cpp_over_c', 'the same: RAM'),
    ('rp2040_first_flash', 'RP2040: `examples/rp2040/first.c`, with `printf`: flash'),
    ('rp2040_first_ram', 'its RAM, without the stack'),
    ('rp2040_first_bus_flash', 'of its flash what the bus costs'),
    ('rp2040_uart_interrupt', 'UART interrupt, a FIFO of bytes'),
    ('rp2040_edge_interrupt', 'edge interrupt'),
    ('rp2040_poll_idle', '`fathom_line_poll` that finds nothing'),
    ('rp2040_poll_with_response', 'the one that gets the response'),
    ('rp2040_hps167s_cpu_share', 'of the processor in `hps167s_rs485`, asleep in between'),
    ('rp2040_poll_bus_time', 'bus time of an HPS-167S poll over what line and sensor allow, 19200 baud'),
    ('stm32f4_first_flash', 'STM32F405: `examples/stm32f4/first.c`, with `printf`: flash'),
    ('stm32f4_first_ram', 'its RAM, without the stack'),
    ('stm32f4_first_bus_flash', 'of its flash what the bus costs'),
]


def page_table(rows):
    lines = ['| | measured |', '|---|---|']
    for name, what in IN_PAGE:
        lines.append(f'| {what} | {rows[name]["figure"]} {rows[name]["unit"]} |')
    return '\n'.join(lines) + '\n'


def page(is_update):
    with open(PAGE, encoding='utf-8') as file:
        text = file.read()
    table = page_table(read(FIGURES)[1])
    found = TABLE.findall(text)
    if is_update and len(found) == 1:
        with open(PAGE, 'w', encoding='utf-8') as file:
            file.write(TABLE.sub(lambda _: table, text))
        found = [table]
    good = [names_of(one) for one in found] == [names_of(table)]
    if not good:
        print('the table of include/COST.md has other rows: figures.py --page --update')
    print(f'{int(good)} passed, {int(not good)} failed')
    return 0 if good else 1


def printed_figures(text):
    """{name: (figure, unit)} of what a program has printed"""
    found = {}
    for name, figure, unit in LINE.findall(text):
        if name in found:
            raise ValueError(f'{name} was printed twice')
        found[name] = (figure, unit)
    if not found:
        raise ValueError('no figure was printed')
    return found


def read(path):
    """({group: compiler}, {name: row})"""
    compilers, rows = {}, {}
    if os.path.exists(path):
        with open(path, encoding='utf-8') as file:
            lines = file.read().splitlines()
        compilers = dict(line[2:].split(': ', 1) for line in lines[1:] if line.startswith('# '))
        rows = {row['name']: row for row in csv.DictReader(line for line in lines if not line.startswith('#'))}
    return compilers, rows


def write(path, compilers, rows):
    with open(path, 'w', encoding='utf-8', newline='') as file:
        print(KEPT, file=file)
        for group, compiler in sorted(compilers.items()):
            print(f'# {group}: {compiler}', file=file)
        out = csv.DictWriter(file, ['group', 'name', 'unit', 'figure', 'bound'], lineterminator='\n')
        out.writeheader()
        out.writerows(rows.values())


def problems(found, group, compiler, compilers, rows):
    """Returns what fails: a figure that is over that of the last release or over its bound, or that is missing."""
    lines = [f'{name} was not measured' for name, row in rows.items() if row['group'] == group and name not in found]
    if compilers.get(group) != compiler:
        print(f'{group} has figures of {compilers.get(group)}; these are of {compiler}, so they are not compared')
        return lines
    for name, (figure, unit) in found.items():
        row = rows.get(name, {'group': group, 'unit': unit, 'figure': None, 'bound': ''})
        if (row['group'], row['unit']) != (group, unit):
            lines.append(f'{name}: {unit} of {group}, was {row["unit"]} of {row["group"]}')
        elif judge(name, figure, row['figure'], unit):
            lines.append(f'{name} is over the figure of the last release')
        if row['bound'] != '' and float(figure) > float(row['bound']):
            lines.append(f'{name}: {figure} {unit}, its bound is {row["bound"]}')
    return lines


def update(found, group, compiler, compilers, rows):
    compilers[group] = compiler
    for name in [name for name in rows if rows[name]['group'] == group and name not in found]:
        del rows[name]
    for name, (figure, unit) in found.items():
        bound = rows[name]['bound'] if name in rows else ''
        rows[name] = {'group': group, 'name': name, 'unit': unit, 'figure': figure, 'bound': bound}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--check', action='store_true', help='fail if a figure is over that of the last release')
    parser.add_argument('--update', action='store_true', help='write the figures of a release')
    parser.add_argument('--page', action='store_true', help='check only the table of include/COST.md')
    parser.add_argument('group', nargs='?')
    parser.add_argument('compiler', nargs='?')
    parser.add_argument('program', nargs=argparse.REMAINDER)
    options = parser.parse_args()
    if options.page:
        return page(options.update)
    if not options.program:
        parser.error('PROGRAM is missing')

    done = subprocess.run(options.program, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    print(done.stdout, end='')
    if done.returncode != 0:
        print(f'{options.program[0]} ended with {done.returncode}')
        return 1
    found = printed_figures(done.stdout)
    version = subprocess.run([options.compiler, '-dumpversion'], capture_output=True, text=True, check=True)
    compiler = f'{os.path.basename(options.compiler)} {version.stdout.strip()}'
    compilers, rows = read(FIGURES)
    print(f'{"":40} {"measured":>10} {"release":>10} {"bound":>10}')
    for name, (figure, unit) in found.items():
        row = rows.get(name, {'figure': '', 'bound': ''})
        print(f'{name:40} {figure:>10} {row["figure"]:>10} {row["bound"]:>10} {unit}')
    if options.update:
        update(found, options.group, compiler, compilers, rows)
        write(FIGURES, compilers, rows)
    lines = problems(found, options.group, compiler, compilers, rows) if options.check else []
    print(*lines, f'{max(0, len(found) - len(lines))} passed, {len(lines)} failed', sep='\n')
    return 1 if lines else 0


if __name__ == '__main__':
    sys.exit(main())
