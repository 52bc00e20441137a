# SPDX-License-Identifier: MIT
"""Prints the figures, keeps them in figures.csv and sizes.csv and in the README, and says what is worse than kept."""
import csv
import os
import re

from job import ROWS
from sizes import HEAD, rows
from tools import HERE, MACHINES, ROOT, versions

FIGURES = os.path.join(HERE, 'figures.csv')
SIZES = os.path.join(HERE, 'sizes.csv')
README = os.path.join(ROOT, 'README.md')
TABLE = re.compile(r'(?s)(?<=<!-- figures: kept by tests/bench/run.py --update -->\n).*?(?=<!-- end -->)')
SIZE_TABLE = re.compile(r'(?s)(?<=<!-- sizes: kept by tests/bench/run.py --update -->\n).*?(?=<!-- end -->)')


def verdict(value, bound, stretch):
    if bound is None:
        return ''
    if value > bound:
        return f'OVER by {value - bound}'
    return 'ok, stretch too' if stretch is not None and value <= stretch else 'ok'


def show(figures):
    print(f'{"":50} {"measured":>8} {"bound":>6} {"stretch":>7}')
    for name, what, unit, bound, stretch in ROWS:
        value = figures.get(name)
        line = f'{what:50} {"-" if value is None else value:>8} {bound or "":>6} {stretch or "":>7} {unit:6} '
        print(line + ('NOT MEASURED' if value is None else verdict(value, bound, stretch)))
    print('The bus time of a poll and what the ports cost: tests/firmware/figures.csv')


def show_functions(functions):
    columns = ('m0_256', 'm0_16', 'avr', 'x86')
    print(f'\n{"function: bytes (x86: instructions of a read)":45}' + ''.join(f'{c:>8}' for c in columns))
    for name, costs in sorted(functions.items(), key=lambda item: -item[1].get('m0_256', 0)):
        print(f'{name:45}' + ''.join(f'{costs[c]:>8}' if c in costs else f'{"-":>8}' for c in columns))


def cell(size):
    """flash / RAM / stack; what constants take of the RAM, where they do, after a plus"""
    const = f'+{size["const"]}' if size['const'] else ''
    return f'{size["flash"]} / {size["ram"]}{const} / {size["stack"]}'


def show_sizes(sizes, variables):
    print(f'\n{"bytes: flash / RAM+constants / worst stack":18}\n{"":18}'
          + ''.join(f'{machine.what:>24}' for machine in MACHINES))
    for row in rows():
        print(f'{row:18}' + ''.join(f'{cell(sizes[row, machine.name]):>24}' for machine in MACHINES))
    print(f'\nRAM by variable: {", ".join(machine.what for machine in MACHINES)}')
    for row in rows():
        names = variables[row, MACHINES[0].name]
        if names:
            print(f'{row:18}' + ', '.join(
                f'{name} {"/".join(str(variables[row, machine.name].get(name, "-")) for machine in MACHINES)}'
                for name in sorted(names)))


def write_csv(path, figures, sizes):
    with open(path, 'w', encoding='utf-8', newline='') as file:
        out = csv.writer(file, lineterminator='\n')
        out.writerow(['name', 'unit', 'measured', 'bound', 'stretch', 'verdict'])
        for name, _, unit, bound, stretch in ROWS:
            if name in figures:
                out.writerow([name, unit, figures[name], bound, stretch,
                              verdict(figures[name], bound, stretch).split(' ')[0].rstrip(',')])
        for (row, machine), size in sizes.items():
            for what in HEAD:
                out.writerow([f'{row}.{machine}.{what}', 'B', size[what], None, None, ''])


def readme_table(figures):
    lines = ['| | measured | bound |', '|---|---|---|']
    for name, what, unit, bound, _ in ROWS:
        lines.append(f'| {what} | {figures[name]} {unit} | {bound or ""} |')
    return '\n'.join(lines) + '\n'


def readme_sizes(sizes):
    lines = ['| | ' + ' | '.join(machine.what for machine in MACHINES) + ' |', '|---' * (1 + len(MACHINES)) + '|']
    for row in rows():
        cells = ' | '.join(cell(sizes[row, machine.name]) for machine in MACHINES)
        lines.append(f'| `{row}` | {cells} |' if row not in ('job', 'everything') else f'| {row} | {cells} |')
    return '\n'.join(lines) + '\n'


def readme():
    with open(README, encoding='utf-8') as file:
        return file.read()


def keep(figures, sizes):
    with open(FIGURES, 'w', encoding='utf-8') as file:
        print(f'# {versions()}', file=file)
        print('name,figure', file=file)
        for row in ROWS:
            print(f'{row[0]},{figures[row[0]]}', file=file)
    with open(SIZES, 'w', encoding='utf-8') as file:
        print(','.join(['row', *(f'{machine.name}.{what}' for machine in MACHINES for what in HEAD)]), file=file)
        for row in rows():
            print(','.join([row, *(str(sizes[row, machine.name][what]) for machine in MACHINES for what in HEAD)]),
                  file=file)
    # count=1: after an empty table a second match would begin in the same place.
    text = TABLE.sub(readme_table(figures), readme(), count=1)
    text = SIZE_TABLE.sub(readme_sizes(sizes), text, count=1)
    with open(README, 'w', encoding='utf-8') as file:
        file.write(text)


def kept():
    """Versions, figures and sizes."""
    with open(FIGURES, encoding='utf-8') as file:
        made_with = file.readline()[1:].strip()
        figures = {row['name']: int(row['figure']) for row in csv.DictReader(file)}
    with open(SIZES, encoding='utf-8') as file:
        sizes = {(row['row'], machine.name): {what: int(row[f'{machine.name}.{what}']) for what in HEAD}
                 for row in csv.DictReader(file) for machine in MACHINES if f'{machine.name}.flash' in row}
    return made_with, figures, sizes


def worse(figures, before, made_with, here_is):
    """What is worse than it was, as lines; what is better is only printed."""
    if made_with != here_is:
        return [f'figures.csv was made with {made_with}; here is {here_is}: nothing to compare']
    lines = []
    for name, what, unit, _, _ in ROWS:
        compare(lines, what, before.get(name), figures[name], unit)
    return lines


def worse_sizes(sizes, before):
    lines = []
    for place, size in sizes.items():
        for what in HEAD:
            compare(lines, f'{what} of {" on ".join(place)}', before.get(place, {}).get(what), size[what], 'B')
    lines += [f'sizes.csv has {" on ".join(place)}, which is measured no more' for place in before
              if place not in sizes]
    return lines


def compare(lines, what, was, now, unit):
    if was is None or now > was:
        lines.append(f'WORSE: {what}: {now} {unit}, was {was}')
    elif now < was:
        print(f'better: {what}: {now} {unit}, was {was}; keep it with run.py --update')


def not_in_readme(figures, sizes):
    lines = []
    for pattern, table, name in ((TABLE, readme_table(figures), 'figures.csv'),
                                 (SIZE_TABLE, readme_sizes(sizes), 'sizes.csv')):
        if pattern.findall(readme()) != [table]:
            lines.append(f'the table of README.md is not that of {name}: run.py --update')
    return lines
