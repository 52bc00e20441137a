# SPDX-License-Identifier: MIT
"""Flash, RAM and the worst stack of modules that stand alone, of the job, of each driver, and of everything, on each
machine.

Flash is text + data less that of an empty main: the library, what it needs of the compiler's, and the user's code.
Of a module: all its functions and what they stand on, and no user. RAM is what the user has to provide: driver, line,
transport and frame, but not the constants, which on AVR stand in RAM too and are counted apart. Stack is the deepest of
all calls of the library that the program makes, without the user's own functions and those of the HAL.
"""
import os
import re
from concurrent.futures import ThreadPoolExecutor

from stack import Image
from job import JOBS
from tools import HERE, LIBRARY, MACHINES, Failed, here, run, source

ALONE = ['crc16', 'crc16_small', 'modbus_rtu', 'dyp_stream', 'dyp_55aa', 'pulse_width', 'hps167s_registers',
         'hps167_frames', 'median', 'level', 'alarm']
FOLDER = os.path.join(HERE, 'sizes')
HEAD = 'flash', 'ram', 'const', 'stack'


def programs():
    """Those of sizes/programs.h, in its order."""
    with open(os.path.join(FOLDER, 'programs.h'), encoding='utf-8') as file:
        return re.findall(r'^ +X\((\w+)\)', file.read(), re.M)


def rows():
    return [*ALONE, *JOBS, *programs(), 'everything']


# Everything at once is more flash and RAM than an ATmega328P has; the linker is told that it had more, to see how much.
ROOMY = ['-Wl,--defsym=__TEXT_REGION_LENGTH__=64K', '-Wl,--defsym=__DATA_REGION_LENGTH__=4K']


class Builder:
    """The library, the programs and the HAL for one machine, compiled once and linked for each row."""

    def __init__(self, machine, work):
        self.machine = machine
        self.work = os.path.join(work, 'sizes_' + machine.name)
        os.mkdir(self.work)
        self.archive = os.path.join(self.work, 'libfathom.a')
        self.sources = [*source(*sorted(name for name in LIBRARY if not name.startswith('crc16'))), machine.crc]
        self.programs = [os.path.join(FOLDER, name) for name in sorted(os.listdir(FOLDER))
                         if name.endswith('.c') and name != 'main.c'] + here('mcu.c')

    def object(self, path):
        folder, name = os.path.split(path)
        return os.path.join(self.work, f'{os.path.basename(folder)}_{name[:-2]}.o')

    def compile(self, path):
        self.machine.build(self.object(path), '-g', '-c', path)

    def archive(self):
        run(self.machine.prefix + 'ar', 'rcs', self.archive, *(self.object(path) for path in self.sources))
        self.empty = os.path.join(self.work, 'empty.elf')
        self.machine.build(self.empty, *self.machine.link, *here('empty.c'))

    def link(self, row):
        """Links a row; returns its path and the library's functions that only a user would call."""
        elf = os.path.join(self.work, row + '.elf')
        arguments, roots = ['-g', *self.machine.link, *self.machine.registers], []
        if row in ALONE:
            path = self.machine.crc if row == 'crc16' else source(row + '.c')[0]
            if row == 'crc16_small':
                self.compile(path)
                arguments.append(self.object(path))
            symbols = self.machine.symbols(self.object(path))
            roots = [name for name, (_, _, kind) in symbols.items() if kind == 'T']
            arguments += [*here('empty.c'), *(f'-Wl,-u,{name}' for name in roots)]
        elif row in JOBS:
            arguments += [*JOBS[row], *here('job.c', 'job_main.c', 'mcu.c')]
        else:
            arguments += [f'-DBEGIN={row}_begin', f'-DUSE={row}_use', os.path.join(FOLDER, 'main.c'),
                          *(self.object(path) for path in self.programs)]
        if self.machine.is_avr and row == 'everything':
            arguments += ROOMY
        self.machine.build(elf, *arguments, self.archive, '-lgcc')
        return elf, roots

    def measure(self, row):
        """{'flash': ...}, {symbol in RAM: bytes}, and the calls that take most stack, outermost first"""
        elf, roots = self.link(row)
        machine = self.machine
        variables = {name: size for name, (_, size, kind) in machine.symbols(elf).items() if kind in 'bB'}
        for name in ('values', 'listener', 'unasked'):  # the user's own in the job
            variables.pop(name, None)
        constants = {name: size for name, (_, size, kind) in machine.symbols(elf).items() if kind in 'dD'}
        if constants and not machine.is_avr:
            raise Failed(f'{row}: initialised variables: {constants}')
        image = Image(machine.prefix, elf)
        if row in ALONE:
            calls = [image.address_of(root) for root in roots]
        else:
            calls = image.users_calls(is_user)
        chain = image.chain(calls)
        figures = (machine.flash(elf) - machine.flash(self.empty), sum(variables.values()),
                   sum(constants.values()), sum(frame for _, frame in chain))
        return dict(zip(HEAD, figures)), variables, chain


def is_user(name):
    """Is this the name of a function of the programs, the job or the stubs?"""
    return name.startswith('tests/bench/')


def measure_sizes(work):
    """{(row, machine): ...} of each of the three that Builder.measure() has"""
    figures, variables, chains = {}, {}, {}
    builders = [Builder(machine, work) for machine in MACHINES]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda job: job[0].compile(job[1]),
                      [(b, path) for b in builders for path in [*b.sources, *b.programs]]))
        list(pool.map(Builder.archive, builders))
        jobs = [(b, row) for row in rows() for b in builders]
        for (b, row), found in zip(jobs, pool.map(lambda job: job[0].measure(job[1]), jobs)):
            place = row, b.machine.name
            figures[place], variables[place], chains[place] = found
    return figures, variables, chains
