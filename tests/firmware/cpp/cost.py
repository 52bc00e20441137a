#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""cost.py m0|avr: what program.cpp costs over program.c, the same program in C, with two drivers.

Flash is text + data, RAM is data + bss, of images that link everything but the start-up code of a C library. The bounds
of figures.csv allow for the constructor and its entry in the table of constructors, on an AVR with the code of libgcc
that runs it, and for the address of the bus in RAM."""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'bench'))
from tools import AVR, HERE, INCLUDE, LIBRARY, M0, run

FOLDER = os.path.dirname(os.path.abspath(__file__))
DRIVERS = {'hps167s': ['-DON=modbus'], 'a16_auto': ['-DON=line', '-DLISTENS']}
MACHINES = {'m0': M0, 'avr': AVR}
SMALL = ['-Os', '-ffunction-sections', '-fdata-sections', '-Wl,--gc-sections']
CXX = ['-std=c++11', '-fno-exceptions', '-fno-rtti']


def sizes(machine, elf):
    text, data, bss = map(int, run(machine.prefix + 'size', elf).splitlines()[1].split()[:3])
    return {'flash': text + data, 'ram': data + bss}


def compile_to(machine, work, path, *options):
    """The object of a source, C or C++."""
    compiler, *flags = machine.compiler
    object_ = os.path.join(work, os.path.basename(path) + '.o')
    language = [compiler[:-len('gcc')] + 'g++', *flags, *CXX] if path.endswith('.cpp') else [*machine.compiler, '-std=c99']
    run(*language, *SMALL, *INCLUDE, '-I' + FOLDER, *options, '-c', path, '-o', object_)
    return object_


def main(name):
    machine = MACHINES[name]
    with tempfile.TemporaryDirectory() as work:
        library = [compile_to(machine, work, path) for path in
                   [os.path.join(HERE, 'mcu.c'), machine.crc,
                    *(path for base, path in LIBRARY.items() if not base.startswith('crc16'))]]
        for driver, options in DRIVERS.items():
            bus = compile_to(machine, work, os.path.join(FOLDER, 'bus.c'), *options)
            found = {}
            for program in ('program.c', 'program.cpp'):
                user = compile_to(machine, work, os.path.join(FOLDER, program), f'-DDRIVER={driver}', *options)
                elf = os.path.join(work, 'program.elf')
                run(*machine.compiler, *SMALL, *machine.link, *machine.registers, user, bus, *library, '-lgcc', '-o', elf)
                found[program] = sizes(machine, elf)
            for what, plain in found['program.c'].items():
                over = found['program.cpp'][what]
                print(f'{driver}: {what} {plain} B in C, {over} B in C++')
                print(f'figure {name}_{driver}_{what}_cpp_over_c {over - plain} B')


if __name__ == '__main__':
    main(sys.argv[1])
