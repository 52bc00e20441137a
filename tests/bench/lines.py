#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what it costs to read many lines: lines/ in one thread, beside libmodbus with a thread a line.

    lines.py PROGRAM              prints the table: CPU and system calls a transaction; three minutes
    lines.py PROGRAM --update     also keeps it, in lines.csv and README.md here
    lines.py PROGRAM --try        a moment with two lines: is every reading right, and is the page what is kept?
    lines.py --self-test          shows that this can fail

PROGRAM is bench_lines (lines/main.c). Times depend on the machine and on what else it does: nothing fails for them.
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


def rows_of(text):
    """Of all rounds but the first: {(lines, way): [CPU a transaction in us]}"""
    found = collections.defaultdict(list)
    for row in csv.DictReader(text.splitlines()):
        if int(row['wrong']) != 0 or int(row['transactions']) == 0:
            raise Failed(f'{row["way"]} with {row["lines"]} lines: {row["wrong"]} readings were wrong or missing, '
                         f'{row["transactions"]} were right')
        if row['round'] != '0':
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
    lines = ['| lines begin | lines | | CPU a transaction | least to most | of libmodbus | system calls |', '|---' * 7 + '|']
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
        print(f'# {machine()}', file=file)
        out = csv.DictWriter(file, COLUMNS, lineterminator='\n')
        out.writeheader()
        out.writerows(table)
    text = page_pattern().sub(lambda _: page_table(table), report.read(report.PAGE), count=1)
    with open(report.PAGE, 'w', encoding='utf-8') as file:
        file.write(text)


def kept():
    with open(LINES, encoding='utf-8') as file:
        file.readline()
        return list(csv.DictReader(file))


def not_in_page(page, table):
    if page_pattern().findall(page) == [page_table(table)]:
        return []
    return ['the table lines of tests/bench/README.md is not what is kept: lines.py --update']


def try_it(program):
    for begin, ways in BEGINNINGS.items():
        found, _ = run(program, begin, '1', '200', '25', str(TRIED), *ways)
        if sorted(way for _, way in found) != sorted(ways):
            raise Failed(f'{begin}: only {sorted(found)} were measured')
    return not_in_page(report.read(report.PAGE), kept())


def self_test():
    head = 'lines,way,round,time_us,user_us,system_us,transactions,wrong\n'
    right = head + '2,loop,0,9,9,9,1,0\n2,loop,1,9,6,4,5,0\n'
    refused = 0
    for row in ('2,loop,1,9,6,4,5,1\n', '2,loop,1,9,6,4,0,0\n'):
        try:
            rows_of(right + row)
        except Failed:
            refused += 1
    table = [{'begin': begin, 'lines': str(count), 'way': way, 'least': '1.0', 'most': '9.0', 'calls': '',
              'median': '4.0' if way == 'libmodbus' else '3.0'}
             for begin, ways in BEGINNINGS.items() for count in COUNTS for way in ways]
    trace = '7 openat(-1, "/dev/ptmx")\n8 getrusage(RUSAGE_SELF)\n8 read(3)\n7 read(3)\n9 write(3 <unfinished ...>\n' \
            '9 <... write resumed>)\n8 write(3)\n8 getrusage(RUSAGE_SELF)\n8 read(3)\n'
    page = f'<!-- lines: kept by tests/bench/lines.py PROGRAM --update -->\n{page_table(table)}<!-- end -->'
    seen = {
        'a round for warming up is left out': rows_of(right) == {(2, 'loop'): [2.0]},
        'wrong and missing readings are refused': refused == 2,
        '3 over 4 misses 0.6': [figure <= bound for _, figure, bound in verdicts(table)] == [False, True] * 2,
        'three calls of two transactions': calls_of(trace, 2) == 1.5,
        'a page that is kept': not_in_page(page, table) == [],
        'a page that is not': len(not_in_page(page.replace('3.0', '2.0'), table)) == 1,
    }
    return report.judge(seen)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', metavar='PROGRAM', nargs='?')
    parser.add_argument('--update', action='store_true', help='keep the figures')
    parser.add_argument('--try', dest='is_tried', action='store_true', help='see for a moment that it works')
    parser.add_argument('--self-test', action='store_true', help='show that this can fail')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
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
