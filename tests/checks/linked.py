#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the linker puts into an image, from its map: a program that only listens has nothing in it that asks, one that
only reads a contact has no line either. The programs are those of tests/bench/sizes, on a Cortex-M0+ and on this
machine."""
import os
import re
import tempfile
from concurrent.futures import ThreadPoolExecutor

from common import ROOT, files, main, run

PROGRAMS = os.path.join(ROOT, 'tests', 'bench')
LISTENING = {'src/codec/dyp_stream.c', 'src/sensor/dyp.c', 'src/sensor/dyp_auto.c',
             *(f'src/engine/{name}.c' for name in ('line', 'line_due', 'line_listening', 'sensor', 'stream', 'output'))}
CONTACT = {'src/engine/contact.c', 'src/engine/sensor.c', 'src/processing/debounce.c'}
# Program: the sources that may be in its image. A new one is added here by hand, and is not one that asks.
MAY_HAVE = {
    'a16_auto': LISTENING | {'src/sensor/a16_auto.c'},
    'a05_auto': LISTENING | {'src/sensor/a05_auto.c'},
    'a16_switch': CONTACT | {'src/sensor/a16_switch.c'},
    'a05_relay': CONTACT | {'src/sensor/a05_relay.c'},
}
NEVER = re.compile(r'fathom_(modbus_|crc16|line_(init|submit|cancel|cancel_unit|has)$)')

REGISTERS = [f'-Wl,--defsym={name}={0x40000000 + 4 * i}' for i, name in enumerate(
    ('uart_status', 'uart_data', 'timer_us', 'argument', 'outcome', 'level'))]
TARGETS = [
    # name, prefix of its tools, flags
    ('Cortex-M0+', 'arm-none-eabi-', ['-mcpu=cortex-m0plus', '-mthumb']),
    ('host', '', ['-no-pie', '-fno-pie', '-fno-stack-protector']),
]


class Library:
    """src/ of a tree for one target, as an archive; and the programs, as objects."""

    def __init__(self, root, prefix, flags, work):
        self.root, self.work = root, work
        self.compiler = [prefix + 'gcc', *flags, '-std=c99', '-Os', '-ffunction-sections', '-fdata-sections',
                         '-I' + os.path.join(root, 'include'), '-I' + PROGRAMS]
        sources = [path for path in files(root, 'src', ends='.c') if path != 'src/codec/crc16_small.c']
        self.programs = [os.path.join(PROGRAMS, 'sizes', name) for name in sorted(os.listdir(PROGRAMS + '/sizes'))
                         if name.endswith('.c') and name != 'main.c'] + [os.path.join(PROGRAMS, 'mcu.c')]
        self.archive = os.path.join(work, 'libfathom.a')
        self.problems = []
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(self.compile, [*sources, *self.programs]))
        if not self.problems:
            run([prefix + 'ar', 'rcs', self.archive, *map(self.object, sources)], root)

    def object(self, path):
        name = os.path.relpath(path, PROGRAMS) if os.path.isabs(path) else path
        return os.path.join(self.work, name.replace('/', '_')[:-2] + '.o')

    def compile(self, path):
        good, said = run([*self.compiler, '-c', os.path.join(self.root, path), '-o', self.object(path)], self.root)
        if not good:
            self.problems.append(f'{path} does not compile:\n{said}')

    def map(self, program):
        """The linker's map of a program's image, or None."""
        path = os.path.join(self.work, program + '.map')
        good, said = run([*self.compiler, '-nostdlib', '-nostartfiles', '-Wl,-e,main', '-Wl,--gc-sections',
                          f'-Wl,-Map,{path}', *REGISTERS, f'-DBEGIN={program}_begin', f'-DUSE={program}_use',
                          os.path.join(PROGRAMS, 'sizes', 'main.c'), *map(self.object, self.programs),
                          self.archive, '-lgcc', '-o', path[:-4]], self.root)
        if not good:
            self.problems.append(f'{program} does not link:\n{said}')
            return None
        with open(path, encoding='utf-8') as file:
            return file.read()


def kept(text):
    """{source of the library: [name of a section of code or constants that is in the image]}"""
    found, names = {}, {path.replace('/', '_')[:-2]: path for path in files(ROOT, 'src', ends='.c')}
    image = text[text.index('Linker script and memory map'):]
    for name, size, member in re.findall(
            r'^ \.(?:text|rodata)\.(\S+)\s+0x[0-9a-f]+\s+0x([0-9a-f]+) \S+libfathom\.a\((src_\w+)\.o\)', image, re.M):
        if int(size, 16) != 0:
            found.setdefault(names[member], []).append(name)
    return found


def judge(program, target, text):
    sources = kept(text)
    where = f'{program} on {target}, which is made of {", ".join(sorted(sources))}'
    if not any(source.endswith(f'/{program}.c') for source in sources):
        yield f'{where}: its own driver is not in the map, or the map was not understood'
    for source in sorted(set(sources) - MAY_HAVE[program]):
        yield f'{where}: {source} is in the image: {", ".join(sources[source])}'
    for source, names in sorted(sources.items()):
        for name in filter(NEVER.match, names):
            yield f'{where}: {name} of {source} is in the image'


def check(root):
    problems = []
    for target, prefix, flags in TARGETS:
        with tempfile.TemporaryDirectory() as work:
            library = Library(root, prefix, flags, work)
            for program in MAY_HAVE if not library.problems else ():
                text = library.map(program)
                if text is not None:
                    problems += judge(program, target, text)
            problems += library.problems
    return problems


if __name__ == '__main__':
    main(check)
