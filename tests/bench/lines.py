#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what it costs to read many lines: lines/ in one thread, beside libmodbus with a thread for each line.

    lines.py PROGRAM              prints the table, CPU time and system calls of a transaction: three minutes
    lines.py PROGRAM --update     for a release: also writes lines.csv and the table of include/COST.md
    lines.py PROGRAM --try        checks with two lines that every reading is right, and the names in the page's table

PROGRAM is bench_lines (lines/main.c). Times depend on the machine and its load, so no time fails.
"""
import argparse
import collections
import csv
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import report
from tools import HERE

LINES = os.path.join(HERE, 'lines.csv')
KEPT = '# The figures of the last release. Only a release changes this file: tests/bench/lines.py PROGRAM --update.'
ROUNDS, WINDOW_MS, PERIOD_MS = 9, 1000, 50
COUNTS = (1, 32, 256)
# Which way is measured how: all sensors polled at every event, with lines that are due one by one, is past a processor.
BEGINNINGS = {'together': ('loop', 'libmodbus', 'every'), 'spread': ('loop', 'libmodbus')}
WHATS = {'loop': '`fathom_loop.h`, one thread', 'libmodbus': 'libmodbus, a thread a line',
         'every': 'all sensors polled at every event, one thread'}
COLUMNS = ['begin', 'lines', 'way', 'median', 'least', 'most', 'calls']
# The aims: CPU a transaction over libmodbus' with 32 lines, and with 256 lines over that with 32.
AT_MOST, FLAT = 0.6, 1.2
TRIED = 2  # lines


class Failed(Exception):
    pass


def cpu_us(row):
    return (int(row['user_us']) + int(row['system_us'])) / int(row['transactions'])


def rows_of(text, first_round=1):
    """Returns {(lines, way): [CPU time of a transaction in us]} without the rounds before `first_round`."""
    found = collections.defaultdict(list)
    for row in csv.DictReader(text.splitlines()):
        if int(row['wrong']) != 0 or int(row['transactions']) == 0:
            raise Failed(f'{row["way"]} with {row["lines"]} lines: {row["wrong"]} readings were wrong or missing, '
                         f'{row["transactions"]} were right')
        if int(row['round']) >= first_round:
            found[int(row['lines']), row['way']].append(cpu_us(row))
    return found


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    rows = rows_of(done.stdout)
    if done.returncode != 0:
        raise Failed(f'{" ".join(command)}: exit status {done.returncode}')
    return rows, done.stdout


def calls_of(trace, transactions):
    """System calls a transaction in what strace has written: between the two marks, without the far end's."""
    far_end = re.search(r'(?m)^(\d+) .*"/dev/ptmx"', trace).group(1)
    window = trace.split('getrusage(RUSAGE_SELF')[1]
    calls = re.findall(rf'(?m)^(?!{far_end} )\d+ +[a-z0-9_]+\(', window)
    return len(calls) / transactions


def count_calls(program, begin, count, way):
    if shutil.which('strace') is None:
        return ''
    with tempfile.TemporaryDirectory() as work:
        path = os.path.join(work, 'trace')
        _, text = run('strace', '-f', '-o', path, program, begin, '0', str(WINDOW_MS), str(PERIOD_MS), str(count), way)
        with open(path, encoding='utf-8') as file:
            calls = calls_of(file.read(), int(next(csv.DictReader(text.splitlines()))['transactions']))
    return f'{calls:.1f}'


def measure(program):
    """The rows of lines.csv."""
    table = []
    for begin, ways in BEGINNINGS.items():
        found, _ = run(program, begin, str(ROUNDS), str(WINDOW_MS), str(PERIOD_MS), ','.join(map(str, COUNTS)), *ways)
        for (count, way), values in sorted(found.items(), key=lambda item: (item[0][0], ways.index(item[0][1]))):
            # Traced, 256 lines are more than can be kept up with.
            calls = count_calls(program, begin, count, way) if count <= 32 else ''
            table.append(dict(zip(COLUMNS, (begin, str(count), way, *(f'{value:.1f}' for value in (
                statistics.median(values), min(values), max(values))), calls))))
    return table


def medians(table):
    return {(row['begin'], int(row['lines']), row['way']): float(row['median']) for row in table}


def verdicts(table):
    """(what, figure, bound)"""
    found = medians(table)
    for begin in BEGINNINGS:
        at_32 = found[begin, 32, 'loop']
        yield f'{begin}, 32 lines, over libmodbus', at_32 / found[begin, 32, 'libmodbus'], AT_MOST
        yield f'{begin}, 256 lines over 32', found[begin, 256, 'loop'] / at_32, FLAT


def show(table):
    found = medians(table)
    print(f'{"begin":9} {"lines":>5} {"way":10} {"CPU us a transaction":>21} {"least..most":>14} {"of libmodbus":>13} '
          f'{"system calls":>13}')
    for row in table:
        share = float(row['median']) / found[row['begin'], int(row['lines']), 'libmodbus']
        print(f'{row["begin"]:9} {row["lines"]:>5} {row["way"]:10} {row["median"]:>21} '
              f'{row["least"] + ".." + row["most"]:>14} {share:13.2f} {row["calls"] or "-":>13}')
    for what, figure, bound in verdicts(table):
        print(f'{what}: {figure:.2f}, at most {bound}: {"met" if figure <= bound else "MISSED"}')


def page_table(table):
    found = medians(table)
    lines = ['| lines begin | lines | | CPU a transaction | least to most | of libmodbus | system calls |',
             '|---' * 7 + '|']
    for row in table:
        share = float(row['median']) / found[row['begin'], int(row['lines']), 'libmodbus']
        lines.append(f'| {row["begin"]} | {row["lines"]} | {WHATS[row["way"]]} | {row["median"]} us | '
                     f'{row["least"]} to {row["most"]} | {share:.2f} | {row["calls"] or "–"} |')
    lines += ['', '| bounds | measured | at most |', '|---|---|---|']
    lines += [f'| {what} | {figure:.2f}{"" if figure <= bound else ", over"} | {bound} |'
              for what, figure, bound in verdicts(table)]
    return '\n'.join(lines) + '\n'


def machine():
    with open('/proc/cpuinfo', encoding='utf-8') as file:
        model = re.search(r'model name\s*: (.*)', file.read())
    return f'{model.group(1) if model else platform.machine()}, {os.cpu_count()} processors, Linux {platform.release()}'


def page_pattern():
    return report.pattern('lines', 'lines.py PROGRAM')


def keep(table):
    with open(LINES, 'w', encoding='utf-8', newline='') as file:
        print(KEPT, f'# {machine()}', sep='\n', file=file)
        out = csv.DictWriter(file, COLUMNS, lineterminator='\n')
        out.writeheader()
        out.writerows(table)
    text = page_pattern().sub(lambda _: page_table(table), report.read(report.PAGE), count=1)
    with open(report.PAGE, 'w', encoding='utf-8') as file:
        file.write(text)


def kept():
    with open(LINES, encoding='utf-8') as file:
        return list(csv.DictReader(file.read().splitlines()[2:]))


def not_in_page(page, table):
    if [report.names_of(found) for found in page_pattern().findall(page)] == [report.names_of(page_table(table))]:
        return []
    return ['the table lines of include/COST.md has other rows or columns: lines.py --update']


def try_it(program):
    for begin, ways in BEGINNINGS.items():
        for way in ways:  # each with ptys of its own, so that no response is left over from another one
            _, text = run(program, begin, '0', '1000', '25', str(TRIED), way)
            if list(rows_of(text, first_round=0)) != [(TRIED, way)]:
                raise Failed(f'{begin}: {way} was not measured')
    return not_in_page(report.read(report.PAGE), kept())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', metavar='PROGRAM', nargs='?')
    parser.add_argument('--update', action='store_true', help='write the figures of a release')
    parser.add_argument('--try', dest='is_tried', action='store_true', help='check the readings of two lines')
    options = parser.parse_args()
    if options.program is None:
        parser.error('PROGRAM is missing: bench_lines of a build folder')
    try:
        if options.is_tried:
            wrong = try_it(options.program)
            print('\n'.join(wrong))
            return 1 if wrong else 0
        table = measure(options.program)
    except Failed as why:
        print(why, file=sys.stderr)
        return 1
    print(machine())
    show(table)
    if options.update:
        keep(table)
    return 0


if __name__ == '__main__':
    sys.exit(main())
