# SPDX-License-Identifier: MIT
"""Prints the figures beside their bounds, compares them with those of the last release in figures.csv and sizes.csv,
and writes these files and the tables of the pages. A bound that is missed is an aim: it is printed, and it fails
nothing."""
import csv
import os
import re
import sys

from job import COSTS, JOBS, ROWS, UNITS
from sizes import HEAD, programs, rows
from tools import HERE, MACHINES, ROOT, versions

sys.path.append(os.path.join(ROOT, 'tests', 'support'))
from bounds import judge, names_of

FIGURES = os.path.join(HERE, 'figures.csv')
SIZES = os.path.join(HERE, 'sizes.csv')
BOUNDS = os.path.join(HERE, 'bounds.csv')
PEERS = os.path.join(HERE, 'peers.csv')
VALUES = 8  # what the job reads: the user's, and counted with RAM beside the peers
KEPT = '# The figures of the last release. Only a release changes this file: tests/bench/run.py --update.'
# The tables in the pages: (page, name of the table)
PAGE = os.path.join(ROOT, 'include', 'COST.md')
PLACES = [(PAGE, 'figures'), (PAGE, 'sizes'), (PAGE, 'peers'), (os.path.join(ROOT, 'README.md'), 'costs')]
FIRST_PAGE = ('a05_relay', 'a16_pwm', 'a16_auto', 'a05_modbus', 'hps167s')  # of the sizes, on the first page
ANY = 'any driver'  # the worst of all drivers, in bounds.csv


def bounds():
    """{figure of all_figures(): bound}"""
    with open(BOUNDS, encoding='utf-8') as file:
        return {row['figure']: int(row['bound']) for row in csv.DictReader(file)}


def all_figures(figures, sizes):
    """Those of the job, ROW.MACHINE.flash and so on of the sizes, and the worst of all drivers: {name: number}"""
    found = dict(figures)
    for (row, machine), size in sizes.items():
        for what in HEAD:
            found[f'{row}.{machine}.{what}'] = size[what]
    for machine in MACHINES:
        for what in HEAD:
            values = [found[f'{row}.{machine.name}.{what}'] for row in programs()
                      if f'{row}.{machine.name}.{what}' in found]
            if values:
                found[f'{ANY}.{machine.name}.{what}'] = max(values)
    return found


def verdict(value, bound):
    if bound is None:
        return ''
    return 'met' if value <= bound else f'MISSED by {value - bound}'


def show(figures, sizes):
    found, aims = all_figures(figures, sizes), bounds()
    print(f'{"":28} {"measured":>8} {"bound":>6}')
    names = [*ROWS, *(name for name in aims if name not in ROWS)]
    for name in names:
        what, unit = ROWS.get(name, ('', 'B'))
        value = found.get(name, '-')
        said = 'NOT MEASURED' if name not in found else verdict(value, aims.get(name))
        print(f'{name:28} {value:>8} {aims.get(name, ""):>6} {unit:6} {said:15} {what}'.rstrip())
    missed = [name for name, bound in aims.items() if name not in found or found[name] > bound]
    print(f'{len(aims) - len(missed)} of {len(aims)} bounds are met'
          + (f'; missed: {", ".join(missed)}' if missed else ''))
    print('The bus time of a poll and what the ports cost: tests/firmware/figures.csv')


def show_functions(functions):
    columns = [f'{job}.{machine}' for job in ('job', 'job_all') for machine in ('m0', 'avr', 'x86')]
    print(f'\n{"function: bytes (x86: instructions of a read)":45}' + ''.join(f'{c:>12}' for c in columns))
    for name, costs in sorted(functions.items(), key=lambda item: -item[1].get('job_all.m0', 0)):
        print(f'{name:45}' + ''.join(f'{costs.get(c, "-"):>12}' for c in columns))


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


def show_chains(chains):
    for (row, machine), chain in chains.items():
        print(f'\n{row} on {machine}: {sum(frame for _, frame in chain)} B of stack')
        for function, frame in chain:
            print(f'{frame:8} {function}')


def write_csv(path, figures, sizes):
    aims = bounds()
    with open(path, 'w', encoding='utf-8', newline='') as file:
        out = csv.writer(file, lineterminator='\n')
        out.writerow(['name', 'unit', 'measured', 'bound', 'verdict'])
        for name, value in all_figures(figures, sizes).items():
            out.writerow([name, ROWS.get(name, ('', 'B'))[1], value, aims.get(name),
                          verdict(value, aims.get(name)).split(' ')[0]])


def beside_bound(value, unit, bound):
    if bound is None:
        return f'{value} {unit}'
    return f'{value} {unit}, {"" if value <= bound else "over "}{bound}'


def figures_table(figures, sizes):
    """The jobs; then what of the sizes has a bound."""
    aims, found = bounds(), all_figures(figures, sizes)
    lines = ['| | the least | sleeps and cancels | and senders | and masters | the least with counters | all |',
             '|---' * 7 + '|']
    for cost, what, unit in COSTS:
        cells = ' | '.join(beside_bound(figures[f'{job}.{cost}'], unit, aims.get(f'{job}.{cost}')) for job in JOBS)
        lines.append(f'| {what} | {cells} |')
    lines += ['', '| 32 sensors on one line | |', '|---|---|']
    lines += [f'| {what} | {beside_bound(figures[name], unit, aims.get(name))} |' for name, (what, unit) in UNITS.items()]
    lines += ['', '| | ' + ' | '.join(machine.what for machine in MACHINES if machine.name in ('m0', 'avr')) + ' |',
              '|---|---|---|']
    for row, what in dict.fromkeys((name.split('.')[0], name.split('.')[2]) for name in aims if name not in ROWS):
        cells = ' | '.join(beside_bound(found[f'{row}.{machine}.{what}'], 'B', aims.get(f'{row}.{machine}.{what}'))
                           for machine in ('m0', 'avr'))
        lines.append(f'| {row}, {what} | {cells} |')
    return '\n'.join(lines) + '\n'


def sizes_table(sizes, names):
    lines = ['| | ' + ' | '.join(machine.what for machine in MACHINES) + ' |', '|---' * (1 + len(MACHINES)) + '|']
    for row in names:
        cells = ' | '.join(cell(sizes[row, machine.name]) for machine in MACHINES)
        lines.append(f'| {row if row in JOBS or row == "everything" else f"`{row}`"} | {cells} |')
    return '\n'.join(lines) + '\n'


def peers():
    with open(PEERS, encoding='utf-8') as file:
        return list(csv.DictReader(file))


def peers_table(figures):
    lines = ['| | version | M0+ flash | with -flto | M0+ RAM | ATmega328P flash | with -flto | x86-64 instructions '
             '| what it is |', '|---' * 9 + '|']
    for row in peers():
        cells = [row[column] or '–' for column in ('m0_flash', 'm0_flash_lto', 'm0_ram', 'avr_flash', 'avr_flash_lto', 'x86')]
        lines.append(f'| {row["name"]} | {row["version"]} | {" | ".join(cells)} | {row["what"]} |')
    whats = {'job': 'polled; a queue, retries, an announced echo, broadcast, break, any unit, quarantine',
             'job_sleep': 'the same in a program that sleeps by `due_us` and cancels',
             'job_senders': '`job` and devices that send unsolicited frames, slow main loops',
             'job_masters': 'the same and other masters',
             'job_counters': '`job` with counters',
             'job_all': '`job_masters`, echo detection, a listener, error flags of the port, settings of a transaction, '
                        'counters, unit 0'}
    for job, what in whats.items():
        cells = [f'{figures[f"{job}.m0_flash_256"]} / {figures[f"{job}.m0_flash_16"]}',
                 f'{figures[f"{job}.m0_flash_256_lto"]} / {figures[f"{job}.m0_flash_16_lto"]}',
                 f'{figures[f"{job}.m0_ram"] + VALUES}', f'{figures[f"{job}.avr_flash"]}',
                 f'{figures[f"{job}.avr_flash_lto"]}',
                 f'{figures[f"{job}.x86_transaction"]}']
        lines.append(f'| **Fathom**, `{job}` | this | {" | ".join(cells)} | {what} |')
    return '\n'.join(lines) + '\n'


def first_page_table(figures, sizes):
    """The peers' clients, ours, and whole programs with a driver, in one table."""
    lines = ['| | Cortex-M0+ flash / RAM | ATmega328P flash | x86-64 instructions | how it works |', '|---' * 5 + '|']
    for row in peers():
        if row['version'].startswith('3.1.12'):
            continue  # libmodbus once more
        flash = f'{row["m0_flash"]} / {row["m0_ram"]}' if row['m0_flash'] else '–'
        lines.append(f'| {row["name"]} | {flash} | {row["avr_flash"] or "–"} | {row["x86"]} | {row["short"]} |')
    lines.append(f'| **Fathom**, Modbus client | {figures["job.m0_flash_256"]} / {figures["job.m0_ram"] + VALUES} | '
                 f'{figures["job.avr_flash"]} | {figures["job.x86_transaction"]} | polled, queue |')
    for row in FIRST_PAGE:
        m0, avr = sizes[row, 'm0'], sizes[row, 'avr']
        lines.append(f'| **Fathom**, `{row}` | {m0["flash"]} / {m0["ram"]} | {avr["flash"]} | | whole program |')
    return '\n'.join(lines) + '\n'


def tables(figures, sizes):
    """Of the pages, in the order of PLACES."""
    return (figures_table(figures, sizes), sizes_table(sizes, rows()), peers_table(figures),
            first_page_table(figures, sizes))


def pattern(name):
    return re.compile(rf'(?s)(?<=<!-- {name}: kept by tests/bench/run.py --update -->\n).*?(?=<!-- end -->)')


def read(page):
    with open(page, encoding='utf-8') as file:
        return file.read()


def keep(figures, sizes):
    with open(FIGURES, 'w', encoding='utf-8') as file:
        print(KEPT, f'# {versions()}', 'name,figure', *(f'{name},{figures[name]}' for name in ROWS), sep='\n',
              file=file)
    with open(SIZES, 'w', encoding='utf-8') as file:
        columns = ['row', *(f'{machine.name}.{what}' for machine in MACHINES for what in HEAD)]
        print(KEPT, f'# {versions()}', ','.join(columns), sep='\n', file=file)
        for row in rows():
            print(row, *(sizes[row, machine.name][what] for machine in MACHINES for what in HEAD), sep=',', file=file)
    for (page, name), table in zip(PLACES, tables(figures, sizes)):
        text = pattern(name).sub(lambda _, table=table: table, read(page), count=1)
        with open(page, 'w', encoding='utf-8') as file:
            file.write(text)


def kept(path):
    """Returns the compilers of a file of figures and its rows."""
    with open(path, encoding='utf-8') as file:
        lines = file.read().splitlines()
    return lines[1][2:], list(csv.DictReader(lines[2:]))


def kept_figures():
    """Returns {name: figure} of the last release, of the job and of the sizes, and the compilers of both."""
    compilers, found = kept(FIGURES)
    compilers_of_sizes, sizes = kept(SIZES)
    figures = {row['name']: int(row['figure']) for row in found}
    figures.update({f'{row["row"]}.{column}': int(value) for row in sizes for column, value in row.items()
                    if column != 'row'})
    return figures, {compilers, compilers_of_sizes}


def drivers():
    names = sorted(os.listdir(os.path.join(ROOT, 'include', 'fathom', 'sensor')))
    return [name[:-2] for name in names if name.startswith(('a16_', 'a05_', 'hps167s'))]


def problems(now, before, compilers, here):
    """Returns what fails: a figure that is over, and one of the last release or of a bound that is not measured."""
    found = [f'{name} was not measured' for name in sorted({*before, *bounds()} - set(now))]
    found += [f'sizes/ has no program for the driver {name}' for name in drivers() if name not in rows()]
    if compilers != {here}:
        print(f'figures.csv and sizes.csv are of {" and of ".join(sorted(compilers))}; these figures are of {here}, so '
              'they are not compared')
        return found
    units = {name: unit for name, (_, unit) in ROWS.items()}
    return found + [f'{name} is over' for name, figure in now.items()
                    if not name.startswith(ANY) and judge(name, figure, before.get(name), units.get(name, 'B'))]


def not_in_pages(figures, sizes):
    """Returns the tables of the pages that have other rows or columns than are measured."""
    return [f'the table {name} of {os.path.relpath(page, ROOT)} has other rows or columns: run.py --update'
            for (page, name), table in zip(PLACES, tables(figures, sizes))
            if [names_of(found) for found in pattern(name).findall(read(page))] != [names_of(table)]]
