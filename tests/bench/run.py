#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what Fathom costs and prints it against its bounds.

    run.py            prints the table; exit status 0 unless something could not be measured
    run.py --check    also fails when a figure is worse than the one kept in figures.csv, or when the README's
                      table is not what is kept
    run.py --update   also keeps today's figures there, and in the README's table
    run.py --csv FILE also writes the table as CSV
    run.py --functions
                      also prints which function costs what

The job (job.c): functions 03 (4 registers), 06 and 16 with modbus_client on line, over a stub UART (mcu.c),
-Os, unused sections dropped, the user's code included. Flash is text + data less that of an empty main.
"""
import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
FIGURES = os.path.join(HERE, 'figures.csv')
README = os.path.join(ROOT, 'README.md')
TABLE = re.compile(r'(?s)(?<=<!-- figures: kept by tests/bench/run.py --update -->\n).*?(?=<!-- end -->)')

# name, what, unit, bound, stretch
ROWS = [
    ('m0_flash_256', 'Cortex-M0+ flash of the job, CRC table of 256', 'B', 2150, 2000),
    ('m0_flash_16', 'Cortex-M0+ flash of the job, CRC table of 16', 'B', 1680, 1540),
    ('m0_ram', 'Cortex-M0+ RAM: line + request + 32-byte frame', 'B', 120, 104),
    ('m0_stack', 'Cortex-M0+ stack below fathom_line_poll', 'B', 120, None),
    ('m0_library', 'Cortex-M0+ flash of everything in src/', 'B', 8192, None),
    ('avr_flash', 'ATmega328P flash of the job, port/avr/crc16.c', 'B', 2550, 2400),
    ('avr_ram', 'ATmega328P RAM: line + request + 32-byte frame', 'B', 105, 90),
    ('avr_const', 'ATmega328P RAM for the const structs, apart', 'B', None, None),
    ('avr_stack', 'ATmega328P stack below fathom_line_poll, seen', 'B', 60, None),
    ('avr_transaction', 'ATmega328P, a read of 4 registers, library only', 'cycles', 2400, None),
    ('avr_answer', 'ATmega328P, the poll that gets the answer', 'cycles', None, None),
    ('avr_idle', 'ATmega328P, a poll that waits for it', 'cycles', 420, None),
    ('x86_transaction', 'x86-64 -O2, a read of 4 registers, library only', 'instr.', 680, 600),
    ('x86_two_polls', 'the same, answered before the second poll', 'instr.', None, None),
]

CORE = ['line.c', 'line_receive.c', 'modbus.c', 'modbus_client.c', 'modbus_rtu.c']
USER = re.compile(r'main$|job_|stub_')  # the functions that are not the library's
SMALL = ['-std=c99', '-Os', '-ffunction-sections', '-fdata-sections', '-Wl,--gc-sections']
ARM = ['arm-none-eabi-gcc', '-mcpu=cortex-m0plus', '-mthumb'] + SMALL
AVR = ['avr-gcc', '-mmcu=atmega328p'] + SMALL
# Registers of mcu.c: any on the ARM; GPIOR2, GPIOR1 and RAM above the job's on the AVR.
ARM_REGISTERS = ['-Wl,--defsym=uart_status=0x40000000,--defsym=uart_data=0x40000004,'
                 '--defsym=timer_us=0x40000008']
AVR_REGISTERS = ['-Wl,--defsym=uart_status=0x80004B,--defsym=uart_data=0x80004A,--defsym=timer_us=0x800700']
AVR_TIMER = '800700'

# Where the indirect calls of the job lead, by the text of the call. None: to the user's code.
INDIRECT = {
    'uart->read': None,
    'uart->write': None,
    'uart->sent': None,
    'clock->now_us': None,
    'listener->receive': None,
    'uart->set_line': None,
    'uart->set_break': None,
    'x->protocol': 'modbus_client.c:protocol',
    'line->protocol': 'modbus_client.c:protocol',
    'exchange->protocol': 'modbus_client.c:protocol',
}


class Failed(Exception):
    """A figure could not be measured."""


def run(*command):
    if shutil.which(command[0]) is None:
        raise Failed(f'{command[0]} is not installed')
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Failed(f'{" ".join(command)}\n{done.stdout}{done.stderr}')
    return done.stdout


def here(*names):
    return [os.path.join(HERE, name) for name in names]


def source(*names):
    return [os.path.join(ROOT, 'src', name) for name in names]


INCLUDE = ['-I' + os.path.join(ROOT, 'include'), '-I' + HERE]


def flash(prefix, elf):
    """text + data"""
    text, data = run(prefix + 'size', elf).splitlines()[1].split()[:2]
    return int(text) + int(data)


def symbols(prefix, elf):
    """{name: (address, size)}"""
    found = {}
    for line in run(prefix + 'nm', '-S', elf).splitlines():
        fields = line.split()
        if len(fields) == 4:
            found[fields[3]] = (int(fields[0], 16), int(fields[1], 16))
    return found


def note_sizes(functions, column, table):
    for name, (_, size) in table.items():
        if name not in ('line', 'request', 'frame', 'values'):
            functions.setdefault(name, {})[column] = size


def ram(table):
    return sum(table[name][1] for name in ('line', 'request', 'frame'))


def measure_arm(work, figures, functions):
    alone = ['-nostdlib', '-nostartfiles', '-Wl,-e,main']
    empty = os.path.join(work, 'm0_empty.elf')
    run(*ARM, *alone, *here('empty.c'), '-o', empty)
    for entries, crc in ((256, 'crc16.c'), (16, 'crc16_small.c')):
        elf = os.path.join(work, f'm0_{entries}.elf')
        run(*ARM, *alone, *ARM_REGISTERS, *INCLUDE, *here('job.c', 'mcu.c'), *source(*CORE, crc),
            '-lc', '-lgcc', '-o', elf)
        figures[f'm0_flash_{entries}'] = flash('arm-none-eabi-', elf) - flash('arm-none-eabi-', empty)
        note_sizes(functions, f'm0_{entries}', symbols('arm-none-eabi-', elf))
    figures['m0_ram'] = ram(symbols('arm-none-eabi-', elf))
    figures['m0_stack'] = stack_of(work, 'fathom_line_poll')
    total = 0
    for name in sorted(os.listdir(os.path.join(ROOT, 'src'))):
        if name.endswith('.c') and name != 'crc16_small.c':
            obj = os.path.join(work, 'm0_' + name + '.o')
            run(*ARM, *INCLUDE, '-c', *source(name), '-o', obj)
            total += flash('arm-none-eabi-', obj)
    figures['m0_library'] = total


def stack_of(work, function):
    """The deepest stack below a function, from gcc's call graph."""
    sizes, calls = {}, {}
    for name in [*CORE, 'crc16.c']:
        obj = os.path.join(work, name[:-2] + '.o')
        run(*ARM, *INCLUDE, '-fcallgraph-info=su', '-c', *source(name), '-o', obj)
        with open(obj[:-1] + 'ci', encoding='utf-8') as file:
            read_call_graph(file.read(), name, sizes, calls)

    return deepest(function, sizes, calls)


def deepest(node, sizes, calls, path=()):
    if node in path:
        raise Failed('recursion: ' + ' > '.join((*path, node)))
    if node not in sizes:
        raise Failed(f'the stack of {node} is not known')
    return sizes[node] + max([deepest(n, sizes, calls, (*path, node)) for n in calls.get(node, ())], default=0)


def read_call_graph(text, name, sizes, calls):
    def short(title):  # /path/to/line.c:scan is a static function
        return os.path.basename(title) if '/' in title else title

    with open(source(name)[0], encoding='utf-8') as file:
        lines = file.read().splitlines()
    for title, label in re.findall(r'node: \{ title: "([^"]+)" label: "([^"]*)"', text):
        size = re.search(r'(\d+) bytes \((\w+)', label)
        if size is not None:
            if size[2] != 'static':
                raise Failed(f'{title} has a stack frame whose size is not known')
            sizes[short(title)] = int(size[1])
    for caller, callee, where in re.findall(
            r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)" label: "[^"]*:(\d+):\d+"', text):
        if callee == '__indirect_call':
            found = re.findall(r'\w+->\w+(?=\()', lines[int(where) - 1])
            known = [call for call in found if call in INDIRECT]
            if len(known) != 1:
                raise Failed(f'src/{name}:{where}: where does this indirect call lead? {lines[int(where) - 1]}')
            callee = INDIRECT[known[0]]
            if callee is None:
                continue
        calls.setdefault(short(caller), set()).add(short(callee))


def measure_avr(work, figures, functions):
    empty, elf = os.path.join(work, 'avr_empty.elf'), os.path.join(work, 'avr.elf')
    run(*AVR, *here('empty.c'), '-o', empty)
    run(*AVR, *AVR_REGISTERS, *INCLUDE, *here('job.c', 'mcu.c'), *source(*CORE),
        os.path.join(ROOT, 'port', 'avr', 'crc16.c'), '-o', elf)
    table = symbols('avr-', elf)
    note_sizes(functions, 'avr', table)
    figures['avr_flash'] = flash('avr-', elf) - flash('avr-', empty)
    figures['avr_ram'] = ram(table)
    figures['avr_const'] = sum(table[name][1] for name in ('config', 'uart', 'clock'))

    simulator = os.path.join(work, 'avr')
    run('gcc', '-O2', *here('avr.c'), '-lsimavr', '-o', simulator)
    users = []
    for address, size in sorted(place for name, place in table.items() if USER.match(name)):
        users += [f'{address:x}', f'{address + size - 1:x}']
    printed = run(simulator, elf, f'{table["fathom_line_poll"][0]:x}',
                  f'{table["fathom_modbus_read_holding_registers"][0]:x}', AVR_TIMER, *users)
    for name, value in re.findall(r'^(transaction|idle|answer|stack) (\d+)$', printed, re.M):
        figures['avr_' + name] = int(value)


def measure_x86(work, figures, functions):
    program = os.path.join(work, 'x86')
    run('gcc', '-std=c99', '-O2', *INCLUDE, *here('job.c', 'host.c'), *source(*CORE, 'crc16.c'), '-o', program)
    figures['x86_two_polls'] = sum(instructions(work, program, 'two').values())
    costs = instructions(work, program)
    figures['x86_transaction'] = sum(costs.values())
    for name, cost in costs.items():
        functions.setdefault(name, {})['x86'] = cost


def instructions(work, *command):
    """{function of the library: instructions in one transaction}"""
    counts = os.path.join(work, 'callgrind.out')
    times = int(run('valgrind', '--quiet', '--tool=callgrind', '--compress-strings=no', '--compress-pos=no',
                    '--toggle-collect=job_read', '--callgrind-out-file=' + counts, *command))
    costs, function, is_call = {}, None, False
    with open(counts, encoding='utf-8') as file:
        for line in file:
            if line.startswith('fn='):
                function = line[3:].strip()
            elif line.startswith('calls='):
                is_call = True
            elif re.match(r'\d+ \d+$', line):
                # The line after calls= is what was spent in the callee, which has its own entry.
                if not is_call and not USER.match(function):
                    costs[function] = costs.get(function, 0) + int(line.split()[1])
                is_call = False
    if not costs or any(cost % times for cost in costs.values()):
        raise Failed(f'the instructions of {times} transactions are not all alike: {costs}')
    return {name: cost // times for name, cost in costs.items()}


def versions():
    return ', '.join(f'{name} {run(name, "-dumpversion").strip()}' for name in
                     ('gcc', 'arm-none-eabi-gcc', 'avr-gcc'))


def kept_figures():
    with open(FIGURES, encoding='utf-8') as file:
        kept_versions = file.readline()[1:].strip()
        return kept_versions, {row['name']: int(row['figure']) for row in csv.DictReader(file)}


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
    print('Not measured here: the bus time of a poll, which needs a UART port for the ATmega328P.')


def show_functions(functions):
    columns = ('m0_256', 'm0_16', 'avr', 'x86')
    print(f'\n{"function: bytes (x86: instructions of a read)":45}' + ''.join(f'{c:>8}' for c in columns))
    for name, costs in sorted(functions.items(), key=lambda item: -item[1].get('m0_256', 0)):
        print(f'{name:45}' + ''.join(f'{costs[c]:>8}' if c in costs else f'{"-":>8}' for c in columns))


def readme_table(figures):
    lines = ['| | measured | bound |', '|---|---|---|']
    for name, what, unit, bound, _ in ROWS:
        lines.append(f'| {what} | {figures[name]} {unit} | {bound or ""} |')
    return '\n'.join(lines) + '\n'


def readme():
    with open(README, encoding='utf-8') as file:
        return file.read()


def write_csv(path, figures):
    with open(path, 'w', encoding='utf-8', newline='') as file:
        out = csv.writer(file, lineterminator='\n')
        out.writerow(['name', 'unit', 'measured', 'bound', 'stretch', 'verdict'])
        for name, _, unit, bound, stretch in ROWS:
            if name in figures:
                out.writerow([name, unit, figures[name], bound, stretch,
                              verdict(figures[name], bound, stretch).split(' ')[0].rstrip(',')])


def worse(figures, kept, made_with, here_is):
    """What is worse than it was, as lines; what is better is only printed."""
    if made_with != here_is:
        return [f'figures.csv was made with {made_with}; here is {here_is}: nothing to compare']
    lines = []
    for name, what, unit, _, _ in ROWS:
        before, now = kept.get(name), figures[name]
        if before is None or now > before:
            lines.append(f'WORSE: {what}: {now} {unit}, was {before}')
        elif now < before:
            print(f'better: {what}: {now} {unit}, was {before}; keep it with run.py --update')
    return lines


def self_test():
    """The comparison and the call graph see what they are there for."""
    same = {row[0]: 100 for row in ROWS}
    assert worse(same, same, 'gcc 1', 'gcc 1') == []
    assert len(worse(same, same, 'gcc 1', 'gcc 2')) == 1
    for name in same:
        assert len(worse(dict(same, **{name: 101}), same, 'gcc 1', 'gcc 1')) == 1
        assert len(worse(same, {k: v for k, v in same.items() if k != name}, 'gcc 1', 'gcc 1')) == 1
    marked = '<!-- figures: kept by tests/bench/run.py --update -->\n%s<!-- end -->'
    assert TABLE.findall(marked % readme_table(same)) == [readme_table(same)]
    assert TABLE.findall(marked % readme_table(dict(same, m0_ram=101))) != [readme_table(same)]
    assert verdict(101, 100, 90) == 'OVER by 1'
    assert verdict(100, 100, 90) == 'ok'
    assert verdict(90, 100, 90) == 'ok, stretch too'
    node = 'node: { title: "%s" label: "%s\\nx.c:1:2\\n%s" }\n'
    edge = 'edge: { sourcename: "%s" targetname: "%s" label: "x.c:%d:3" }\n'
    tree = node % ('a', 'a', '8 bytes (static)') + node % ('/p/line.c:b', 'b', '16 bytes (static)')
    good = tree + edge % ('a', '/p/line.c:b', 1)
    for text, depth in ((good, 24), (good + edge % ('/p/line.c:b', 'a', 1), 'recursion'),
                        (good + edge % ('a', 'memcpy', 1), 'is not known'),
                        (good + edge % ('a', '__indirect_call', 1), 'where does this indirect call'),
                        (good + node % ('c', 'c', '8 bytes (dynamic)'), 'whose size is not known')):
        sizes, calls = {}, {}
        try:
            read_call_graph(text, 'line.c', sizes, calls)
            found = deepest('a', sizes, calls)
        except Failed as why:
            found = str(why)
        assert found == depth or str(depth) in str(found), (found, depth)
    print('self-test passed')
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--check', action='store_true', help='fail when a figure is worse than the kept one')
    parser.add_argument('--update', action='store_true', help='keep the figures in figures.csv')
    parser.add_argument('--functions', action='store_true', help='print which function costs what')
    parser.add_argument('--self-test', action='store_true', help='show that the comparison works')
    parser.add_argument('--csv', metavar='FILE', help='write the table there as CSV')
    options = parser.parse_args()

    if options.self_test:
        return self_test()
    figures, functions, failed = {}, {}, False
    with tempfile.TemporaryDirectory() as work:
        for measure in (measure_arm, measure_avr, measure_x86):
            try:
                measure(work, figures, functions)
            except Failed as why:
                print(f'{measure.__name__}: {why}', file=sys.stderr)
                failed = True
    show(figures)
    if options.functions:
        show_functions(functions)
    if options.csv:
        write_csv(options.csv, figures)
    if failed or len(figures) != len(ROWS):
        return 1
    if options.update:
        with open(FIGURES, 'w', encoding='utf-8') as file:
            print(f'# {versions()}', file=file)
            print('name,figure', file=file)
            for row in ROWS:
                print(f'{row[0]},{figures[row[0]]}', file=file)
        text = TABLE.sub(readme_table(figures), readme())
        with open(README, 'w', encoding='utf-8') as file:
            file.write(text)
    if not options.check:
        return 0
    made_with, kept = kept_figures()
    lines = worse(figures, kept, made_with, versions())
    if TABLE.findall(readme()) != [readme_table(kept)]:
        lines.append('the table of README.md is not that of figures.csv: run.py --update')
    print('\n'.join(lines))
    return 1 if lines else 0


if __name__ == '__main__':
    sys.exit(main())
