# SPDX-License-Identifier: MIT
"""What all measurements share: folders, compilers, and what the binutils say of a file."""
import glob
import os
import shutil
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))

SMALL = ['-std=c99', '-Os', '-ffunction-sections', '-fdata-sections', '-Wl,--gc-sections']
ALONE = ['-nostdlib', '-nostartfiles', '-Wl,-e,main']
INCLUDE = ['-I' + os.path.join(ROOT, 'include'), '-I' + HERE]


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


# {name: path} of every source of the library.
LIBRARY = {os.path.basename(path): path
           for path in sorted(glob.glob(os.path.join(ROOT, 'src', '**', '*.c'), recursive=True))}


def source(*names):
    return [LIBRARY[name] for name in names]


class Machine:
    """A microcontroller: its compiler, and where the registers are that the programs of this folder use."""

    def __init__(self, name, what, compiler, **registers):
        self.name, self.what, self.compiler = name, what, compiler
        self.prefix = compiler[0][:-len('gcc')]
        self.is_avr = self.prefix == 'avr-'
        # An image that does not start needs neither start-up code nor a libc; avr-gcc's own are part of it.
        self.link = [] if self.is_avr else ALONE
        self.registers = [f'-Wl,--defsym={register}={address}' for register, address in registers.items()]
        self.crc = os.path.join(ROOT, 'port', 'avr', 'crc16.c') if self.is_avr else source('crc16.c')[0]

    def build(self, output, *arguments):
        run(*self.compiler, *SMALL, *INCLUDE, *arguments, '-o', output)

    def flash(self, elf):
        """text + data"""
        text, data = run(self.prefix + 'size', elf).splitlines()[1].split()[:2]
        return int(text) + int(data)

    def symbols(self, elf):
        """{name: (address, size, type as nm has it)}"""
        found = {}
        for line in run(self.prefix + 'nm', '-S', elf).splitlines():
            fields = line.split()
            if len(fields) == 4:
                found[fields[3]] = (int(fields[0], 16), int(fields[1], 16), fields[2])
        return found


# Any address on these; on the AVR GPIOR2, GPIOR1 and RAM above the job's, where avr.c plays a device.
ANY = {'uart_status': '0x40000000', 'uart_data': '0x40000004', 'timer_us': '0x40000008',
       'argument': '0x4000000C', 'outcome': '0x40000010', 'level': '0x40000014'}
M0 = Machine('m0', 'Cortex-M0+', ['arm-none-eabi-gcc', '-mcpu=cortex-m0plus', '-mthumb'], **ANY)
M4 = Machine('m4', 'Cortex-M4', ['arm-none-eabi-gcc', '-mcpu=cortex-m4', '-mthumb'], **ANY)
AVR = Machine('avr', 'ATmega328P', ['avr-gcc', '-mmcu=atmega328p'],
              uart_status='0x80004B', uart_data='0x80004A', timer_us='0x800700', argument='0x800704',
              outcome='0x800706', level='0x800708')
# Debian's has no libc, hence no stdint.h of a hosted system.
RV32 = Machine('rv32', 'RV32IMAC', ['riscv64-unknown-elf-gcc', '-march=rv32imac', '-mabi=ilp32', '-ffreestanding'],
               **ANY)
MACHINES = [M0, M4, AVR, RV32]
AVR_TIMER = '800700'


def versions():
    return ', '.join(f'{name} {run(name, "-dumpversion").strip()}' for name in
                     ('gcc', 'arm-none-eabi-gcc', 'avr-gcc', 'riscv64-unknown-elf-gcc'))
