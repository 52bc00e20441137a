# SPDX-License-Identifier: MIT
"""Measures the job of job.c: functions 03 (4 registers), 06 and 16 with modbus_client on line, over a stub UART
(mcu.c), -Os, unused sections dropped, the user's code included. Flash is text + data less that of an empty main. With
six variants of the job: what the library always has; the same for a program that sleeps and cancels; the first and devices that send by themselves; these
and other masters; the first with counters; and all.

Each measure_ function writes to figures {name: number} and functions {function: {column: cost}}.
"""
import os
import re

from stack import Image
from tools import AVR, AVR_TIMER, INCLUDE, LIBRARY, M0, Failed, here, run, source

# What job.c is compiled with.
JOBS = {'job': [], 'job_sleep': ['-DJOB_SLEEP'], 'job_senders': ['-DJOB_SENDERS'], 'job_masters': ['-DJOB_SENDERS', '-DJOB_MASTERS'],
        'job_counters': ['-DJOB_COUNTERS'],
        'job_all': ['-DJOB_SENDERS', '-DJOB_MASTERS', '-DJOB_COUNTERS', '-DJOB_ALL']}
# Of each: name, what, unit
COSTS = [
    ('m0_flash_256', 'Cortex-M0+ flash, CRC table of 256', 'B'),
    ('m0_flash_16', 'Cortex-M0+ flash, CRC table of 16', 'B'),
    ('m0_flash_256_lto', 'the same with -flto, CRC table of 256', 'B'),
    ('m0_flash_16_lto', 'the same with -flto, CRC table of 16', 'B'),
    ('m0_ram', 'Cortex-M0+ RAM', 'B'),
    ('m0_stack', 'Cortex-M0+ stack below fathom_line_poll', 'B'),
    ('avr_flash', 'ATmega328P flash, port/avr/crc16.c', 'B'),
    ('avr_flash_lto', 'the same with -flto', 'B'),
    ('avr_ram', 'ATmega328P RAM', 'B'),
    ('avr_const', 'ATmega328P RAM for the const structs, apart', 'B'),
    ('avr_stack', 'ATmega328P stack below fathom_line_poll, seen', 'B'),
    ('avr_transaction', 'ATmega328P, a read of 4 registers, library only', 'cycles'),
    ('avr_response', 'ATmega328P, the poll that gets the response', 'cycles'),
    ('avr_idle', 'ATmega328P, a poll that waits for it', 'cycles'),
    ('x86_transaction', 'x86-64 -O2, a read of 4 registers, library only', 'instr.'),
    ('x86_two_polls', 'the same, answered before the second poll', 'instr.'),
]
# Of 32 sensors on one line (units.c), each reading
UNITS = {'units.x86_reading': ('x86-64 -O2, a reading of 32 sensors on one line, library only', 'instr.'),
         'units.port_reads': ('how often the port is read for it', 'reads')}
# {name: (what, unit)}
ROWS = {**{f'{job}.{name}': (what, unit) for job in JOBS for name, what, unit in COSTS}, **UNITS}
# What the user provides: for job_all also what the library writes to, but not the listener, which is the user's own.
RAM = ('line', 'request', 'frame', 'counters', 'modbus')
CORE = source(*sorted(name for name in LIBRARY
                      if re.match(r'(line|modbus_client)\w*\.c$|(modbus|modbus_rtu|dyp_55aa|dyp_stream)\.c$', name)))
JOB = here('job.c', 'job_main.c', 'mcu.c')
GC = ['-ffunction-sections', '-Wl,--gc-sections']
TIMES = 1000
USER = re.compile(r'main$|job_|stub_|units_')  # the functions that are not the library's


def note_sizes(functions, column, table):
    for name, (_, size, _) in table.items():
        if name not in (*RAM, 'values', 'listener', 'unasked'):
            functions.setdefault(name, {})[column] = size


def ram(table):
    return sum(table[name][1] for name in RAM if name in table)


def measure_arm(work, figures, functions):
    empty = os.path.join(work, 'm0_empty.elf')
    M0.build(empty, *M0.link, *here('empty.c'))
    for job, flags in JOBS.items():
        for entries, crc in ((16, 'crc16_small.c'), (256, 'crc16.c')):
            elf = os.path.join(work, f'm0_{job}_{entries}.elf')
            M0.build(elf, '-g', *flags, *M0.link, *M0.registers, *JOB, *CORE, *source(crc), '-lgcc')
            figures[f'{job}.m0_flash_{entries}'] = M0.flash(elf) - M0.flash(empty)
            lto = os.path.join(work, f'm0_{job}_{entries}_lto.elf')
            M0.build(lto, '-flto', *flags, *M0.link, *M0.registers, *JOB, *CORE, *source(crc), '-lgcc')
            figures[f'{job}.m0_flash_{entries}_lto'] = M0.flash(lto) - M0.flash(empty)
        note_sizes(functions, f'{job}.m0', M0.symbols(elf))
        figures[f'{job}.m0_ram'] = ram(M0.symbols(elf))
        image = Image(M0.prefix, elf)
        figures[f'{job}.m0_stack'] = image.deepest(image.address_of('fathom_line_poll'))


def measure_avr(work, figures, functions):
    empty, simulator = os.path.join(work, 'avr_empty.elf'), os.path.join(work, 'avr')
    AVR.build(empty, *here('empty.c'))
    run('gcc', '-O2', *here('avr.c'), '-lsimavr', '-o', simulator)
    for job, flags in JOBS.items():
        elf = os.path.join(work, f'avr_{job}.elf')
        AVR.build(elf, *flags, *AVR.registers, *JOB, *CORE, AVR.crc)
        table = AVR.symbols(elf)
        note_sizes(functions, f'{job}.avr', table)
        figures[f'{job}.avr_flash'] = AVR.flash(elf) - AVR.flash(empty)
        lto = os.path.join(work, f'avr_{job}_lto.elf')
        AVR.build(lto, '-flto', *flags, *AVR.registers, *JOB, *CORE, AVR.crc)
        figures[f'{job}.avr_flash_lto'] = AVR.flash(lto) - AVR.flash(empty)
        figures[f'{job}.avr_ram'] = ram(table)
        figures[f'{job}.avr_const'] = sum(size for _, size, kind in table.values() if kind in 'dD')
        users = []
        for address, size in sorted((at, size) for name, (at, size, _) in table.items() if USER.match(name)):
            users += [f'{address:x}', f'{address + size - 1:x}']
        printed = run(simulator, elf, f'{table["fathom_line_poll"][0]:x}',
                      f'{table["fathom_modbus_read_holding_registers"][0]:x}', AVR_TIMER, *users)
        for name, value in re.findall(r'^(transaction|idle|response|stack) (\d+)$', printed, re.M):
            figures[f'{job}.avr_{name}'] = int(value)


def measure_x86(work, figures, functions):
    for job, flags in JOBS.items():
        program = os.path.join(work, f'x86_{job}')
        run('gcc', '-std=c99', '-O2', *GC, *flags, *INCLUDE, *here('job.c', 'host.c'), *CORE, *source('crc16.c'),
            '-o', program)
        figures[f'{job}.x86_two_polls'] = sum(instructions(work, program, 'two').values())
        costs = instructions(work, program)
        figures[f'{job}.x86_transaction'] = sum(costs.values())
        for name, cost in costs.items():
            functions.setdefault(name, {})[f'{job}.x86'] = cost


def measure_units(work, figures, _):
    program = os.path.join(work, 'x86_units')
    run('gcc', '-std=c99', '-O2', *GC, *INCLUDE, *here('units.c'),
        *source(*sorted(name for name in LIBRARY if name != 'crc16_small.c')), '-o', program)
    # The first readings of the sensors differ: all 32 wait for their first request.
    once, often = (sum(collected(work, 'fathom_poll', program, str(times)).values()) for times in (TIMES, 2 * TIMES))
    figures['units.x86_reading'] = round((often - once) / TIMES)
    figures['units.port_reads'] = int(run(program, str(TIMES)))


def instructions(work, program, *how):
    """{function of the library: instructions in one transaction}; without the first, which may learn something"""
    once, often = (collected(work, 'job_read', program, str(times), *how) for times in (1, 1 + TIMES))
    costs = {name: cost - once.get(name, 0) for name, cost in often.items()}
    if not any(costs.values()) or any(cost % TIMES for cost in costs.values()):
        raise Failed(f'the instructions of {TIMES} transactions are not all alike: {costs}')
    return {name: cost // TIMES for name, cost in costs.items() if cost}


def collected(work, below, *command):
    """{function of the library: instructions in and below the function `below`}"""
    counts = os.path.join(work, 'callgrind.out')
    run('valgrind', '--quiet', '--tool=callgrind', '--compress-strings=no', '--compress-pos=no',
        f'--toggle-collect={below}', '--callgrind-out-file=' + counts, *command)
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
    return costs
