#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Figures that are measured on real images in simulators: cycles, bus time, stack, CPU share. All of them are kept in
figures.csv, with their bounds, and none may get worse. The simulators are deterministic, so a figure is the same each
time for one version of the compiler, which the file names.

    figures.py GROUP COMPILER PROGRAM [ARGUMENT ...]
                                 runs PROGRAM, whose lines "figure NAME VALUE UNIT" are GROUP's, and shows them
    figures.py --check ...       also fails when one is worse than the kept one or over its bound, missing or new
    figures.py --update ...      also keeps them; bounds stay, and are written into the file by hand
    figures.py --page            fails unless the table of tests/bench/README.md is that of figures.csv; with --update it
                                 writes it
    figures.py --self-test       shows that the comparison works

Less is better in all of them. It fails when PROGRAM does, and prints first what that has printed, so PROGRAM may be a
test. NAME begins with the machine's; COMPILER is the one that made the images.
"""
import argparse
import csv
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
FIGURES = os.path.join(HERE, 'figures.csv')
PAGE = os.path.join(os.path.dirname(HERE), 'bench', 'README.md')
TABLE = re.compile(r'(?s)(?<=<!-- firmware: kept by tests/firmware/figures.py --page --update -->\n).*?(?=<!-- end -->)')
LINE = re.compile(r'^figure (\w+) (-?\d+(?:\.\d+)?) (\S+)$', re.M)

# What the page tells of them; the rest is in the file.
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
    ('avr_readme_flash', "the first page's program: flash"),
    ('avr_readme_ram', 'its RAM, without the stack'),
    ('avr_readme_median', 'of its flash the functions of `median`'),
    ('avr_readme_level', 'of its flash those of `level` that it names'),
    ('rp2040_uart_interrupt', 'RP2040: UART interrupt, a FIFO of bytes'),
    ('rp2040_edge_interrupt', 'edge interrupt'),
    ('rp2040_poll_idle', '`fathom_line_poll` that finds nothing'),
    ('rp2040_poll_with_response', 'the one that gets the response'),
    ('rp2040_hps167s_cpu_share', 'of the processor in `hps167s_rs485`, asleep in between'),
    ('rp2040_poll_bus_time', 'bus time of an HPS-167S poll over what line and sensor allow, 19200 baud'),
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
    good = found == [table]
    print('1 passed, 0 failed' if good else 'the table of tests/bench/README.md is not that of figures.csv: figures.py --page --update\n'
          '0 passed, 1 failed')
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
        compilers = dict(line[2:].split(': ', 1) for line in lines if line.startswith('# '))
        rows = {row['name']: row for row in csv.DictReader(line for line in lines if not line.startswith('#'))}
    return compilers, rows


def write(path, compilers, rows):
    with open(path, 'w', encoding='utf-8', newline='') as file:
        for group, compiler in sorted(compilers.items()):
            print(f'# {group}: {compiler}', file=file)
        out = csv.DictWriter(file, ['group', 'name', 'unit', 'figure', 'bound'], lineterminator='\n')
        out.writeheader()
        out.writerows(rows.values())


def is_over(figure, limit):
    return limit != '' and float(figure) > float(limit)


def problems(found, group, compiler, compilers, rows):
    """What is worse than it was, or than it may be, as lines; what is better is only printed."""
    if compilers.get(group) != compiler:
        return [f'{group} was measured with {compilers.get(group)}; here is {compiler}: nothing to compare']
    lines = []
    for name, (figure, unit) in found.items():
        row = rows.get(name)
        if row is None:
            lines.append(f'{name}: {figure} {unit} is not in figures.csv: keep it with --update')
        elif row['group'] != group:
            lines.append(f'{name}: of {group}, was of {row["group"]}')
        elif row['unit'] != unit:
            lines.append(f'{name}: in {unit}, was in {row["unit"]}')
        elif is_over(figure, row['figure']):
            lines.append(f'WORSE: {name}: {figure} {unit}, was {row["figure"]}')
        elif float(figure) < float(row['figure']):
            print(f'better: {name}: {figure} {unit}, was {row["figure"]}; keep it with --update')
        if row is not None and is_over(figure, row['bound']):
            lines.append(f'OVER: {name}: {figure} {unit}, its bound is {row["bound"]}')
    for name, row in rows.items():
        if row['group'] == group and name not in found:
            lines.append(f'{name} was not measured')
    return lines


def update(found, group, compiler, compilers, rows):
    compilers[group] = compiler
    for name in [name for name in rows if rows[name]['group'] == group and name not in found]:
        del rows[name]
    for name, (figure, unit) in found.items():
        bound = rows[name]['bound'] if name in rows else ''
        rows[name] = {'group': group, 'name': name, 'unit': unit, 'figure': figure, 'bound': bound}


def self_test():
    text = 'x\nfigure chip_isr 50 cycles\nfigure chip_bus 0.25 %\nfigures of the day\n'
    found = printed_figures(text)
    assert found == {'chip_isr': ('50', 'cycles'), 'chip_bus': ('0.25', '%')}
    for wrong in (text + 'figure chip_isr 49 cycles\n', 'nothing\n'):
        try:
            printed_figures(wrong)
        except ValueError:
            continue
        raise AssertionError(wrong)
    other = {'group': 'core', 'name': 'core_isr', 'unit': 'cycles', 'figure': '1', 'bound': '2'}
    compilers, rows = {'core': 'cc 2'}, {'core_isr': other}
    update(found, 'chip', 'cc 1', compilers, rows)
    rows['chip_isr']['bound'] = '60'
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'figures.csv')
        write(path, compilers, rows)
        assert read(path) == (compilers, rows)

    def count(change, compiler='cc 1', kept=None):
        return len(problems({**found, **change}, 'chip', compiler, compilers, rows if kept is None else kept))
    assert count({}) == 0
    assert count({'chip_isr': ('49', 'cycles'), 'chip_bus': ('0.24', '%')}) == 0
    assert count({'chip_isr': ('51', 'cycles')}) == 1
    assert count({'chip_isr': ('61', 'cycles')}) == 2
    assert count({'chip_bus': ('0.26', '%')}) == 1
    assert count({'chip_bus': ('0.25', 'us')}) == 1
    assert count({'chip_new': ('1', 'B')}) == 1
    assert count({}, compiler='cc 2') == 1
    assert count({}, kept={**rows, 'chip_gone': {**rows['chip_isr'], 'name': 'chip_gone'}}) == 1
    assert count({}, kept={**rows, 'chip_isr': {**rows['chip_isr'], 'group': 'core'}}) == 1
    loose = {**rows, 'chip_isr': {**rows['chip_isr'], 'figure': '70'}}
    assert count({'chip_isr': ('61', 'cycles')}, kept=loose) == 1
    update({'chip_isr': ('40', 'cycles')}, 'chip', 'cc 3', compilers, rows)
    assert list(rows) == ['core_isr', 'chip_isr'] and rows['chip_isr']['bound'] == '60'
    assert compilers == {'core': 'cc 2', 'chip': 'cc 3'}
    shown = {name: {'figure': '1', 'unit': 'B'} for name, _ in IN_PAGE}
    marked = '<!-- firmware: kept by tests/firmware/figures.py --page --update -->\n%s<!-- end -->'
    assert TABLE.findall(marked % page_table(shown)) == [page_table(shown)]
    changed = {**shown, IN_PAGE[0][0]: {'figure': '2', 'unit': 'B'}}
    assert TABLE.findall(marked % page_table(shown)) != [page_table(changed)]
    print('1 passed, 0 failed')
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--check', action='store_true', help='fail when a figure is worse than the kept one')
    parser.add_argument('--update', action='store_true', help='keep the figures in figures.csv')
    parser.add_argument('--page', action='store_true', help='only look at the table of tests/bench/README.md')
    parser.add_argument('--self-test', action='store_true', help='show that the comparison works')
    parser.add_argument('group', nargs='?')
    parser.add_argument('compiler', nargs='?')
    parser.add_argument('program', nargs=argparse.REMAINDER)
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if options.page:
        return page(options.update)
    if not options.program:
        parser.error('which program measures?')

    done = subprocess.run(options.program, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    print(done.stdout, end='')
    if done.returncode != 0:
        print(f'{options.program[0]} ended with {done.returncode}')
        return 1
    found = printed_figures(done.stdout)
    version = subprocess.run([options.compiler, '-dumpversion'], capture_output=True, text=True, check=True)
    compiler = f'{os.path.basename(options.compiler)} {version.stdout.strip()}'
    compilers, rows = read(FIGURES)
    print(f'{"":40} {"measured":>10} {"kept":>10} {"bound":>10}')
    for name, (figure, unit) in found.items():
        row = rows.get(name, {'figure': '', 'bound': ''})
        print(f'{name:40} {figure:>10} {row["figure"]:>10} {row["bound"]:>10} {unit}')
    if options.update:
        update(found, options.group, compiler, compilers, rows)
        write(FIGURES, compilers, rows)
    # While coverage/run.py looks at what is executed, the figures are not what is tested.
    is_checked = options.check and 'FATHOM_TRACE' not in os.environ
    lines = problems(found, options.group, compiler, compilers, rows) if is_checked else []
    print('\n'.join([*lines, f'{len(found) - len(lines)} passed, {len(lines)} failed']))
    return 1 if lines else 0


if __name__ == '__main__':
    sys.exit(main())
