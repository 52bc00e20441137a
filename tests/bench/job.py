# SPDX-License-Identifier: MIT
"""Measures the job of job.c: functions 03 (4 registers), 06 and 16 with modbus_client on line, over a stub UART
(mcu.c), -Os, unused sections dropped, the user's code included. Flash is text + data less that of an empty main.

Each measure_ function writes to figures {name: number} and functions {function: {column: cost}}.
"""
import os
import re

from stack import Image
from tools import AVR, AVR_TIMER, INCLUDE, M0, ROOT, Failed, here, run, source

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
JOB = here('job.c', 'job_main.c', 'mcu.c')
USER = re.compile(r'main$|job_|stub_')  # the functions that are not the library's


def note_sizes(functions, column, table):
    for name, (_, size, _) in table.items():
        if name not in ('line', 'request', 'frame', 'values'):
            functions.setdefault(name, {})[column] = size


def ram(table):
    return sum(table[name][1] for name in ('line', 'request', 'frame'))


def measure_arm(work, figures, functions):
    empty = os.path.join(work, 'm0_empty.elf')
    M0.build(empty, *M0.link, *here('empty.c'))
    for entries, crc in ((16, 'crc16_small.c'), (256, 'crc16.c')):
        elf = os.path.join(work, f'm0_{entries}.elf')
        M0.build(elf, '-g', *M0.link, *M0.registers, *JOB, *source(*CORE, crc), '-lgcc')
        figures[f'm0_flash_{entries}'] = M0.flash(elf) - M0.flash(empty)
        note_sizes(functions, f'm0_{entries}', M0.symbols(elf))
    figures['m0_ram'] = ram(M0.symbols(elf))
    image = Image(M0.prefix, elf)
    figures['m0_stack'] = image.deepest(image.address_of('fathom_line_poll'))
    total = 0
    for name in sorted(os.listdir(os.path.join(ROOT, 'src'))):
        if name.endswith('.c') and name != 'crc16_small.c':
            obj = os.path.join(work, 'm0_' + name + '.o')
            M0.build(obj, '-c', *source(name))
            total += M0.flash(obj)
    figures['m0_library'] = total


def measure_avr(work, figures, functions):
    empty, elf = os.path.join(work, 'avr_empty.elf'), os.path.join(work, 'avr.elf')
    AVR.build(empty, *here('empty.c'))
    AVR.build(elf, *AVR.registers, *JOB, *source(*CORE), AVR.crc)
    table = AVR.symbols(elf)
    note_sizes(functions, 'avr', table)
    figures['avr_flash'] = AVR.flash(elf) - AVR.flash(empty)
    figures['avr_ram'] = ram(table)
    figures['avr_const'] = sum(table[name][1] for name in ('config', 'uart', 'clock'))

    simulator = os.path.join(work, 'avr')
    run('gcc', '-O2', *here('avr.c'), '-lsimavr', '-o', simulator)
    users = []
    for address, size in sorted((at, size) for name, (at, size, _) in table.items() if USER.match(name)):
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
