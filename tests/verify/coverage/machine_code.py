# SPDX-License-Identifier: MIT
"""Which instructions of the ports for microcontrollers the firmware tests execute, and which of the conditional branches
they see go both ways: by the traces that the simulators write (tests/firmware/avr/trace.h)."""
import collections
import glob
import json
import os
import re
import shutil

from c_code import Broken, run

Machine = collections.namedtuple('Machine', 'port tools kind build')
MACHINES = (Machine('avr', 'avr-', 'avr', 'firmware/avr'),
            Machine('arduino', 'avr-', 'avr', 'firmware/arduino'),
            Machine('rp2040', 'arm-none-eabi-', 'arm', 'firmware/rp2040'),
            Machine('stm32f4', 'arm-none-eabi-', 'arm', 'firmware/stm32f4'),
            Machine('mps2', 'arm-none-eabi-', 'arm', 'firmware/mps2'),
            Machine('virt', 'riscv64-unknown-elf-', 'riscv', 'firmware/virt'))
TESTS = '^firmware\\.(test_avr|test_arduino|test_rp2040|stm32f4|mps2|virt)'

ARM = '(eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)'
CONDITIONAL = {  # whose second way is told by the disassembler
    'avr': re.compile(r'br(?!eak)\w+$'),
    'arm': re.compile(rf'(b{ARM}(\.[nw])?|cbn?z)$'),
    'riscv': re.compile(r'(c\.)?b(eq|ne|lt|ge|ltu|geu|gt|le|gtu|leu|eqz|nez|lez|gez|ltz|gtz)$')}
SKIPS = re.compile(r'(sbrc|sbrs|sbic|sbis|cpse)$')  # avr: the instruction behind it
RETURNS = re.compile(rf'(bx|pop|ldmia(\.w)?|ldr(\.w)?){ARM}(\.[nw])?$')  # arm, under an IT
# Its objects are made by the linker, so that its functions are known by their names alone.
OF_ARDUINO = re.compile(r'_ZN6fathom7arduino')

Instruction = collections.namedtuple('Instruction', 'address name operands')
Function = collections.namedtuple('Function', 'file name')


def output(*command):
    code, said = run(list(command))
    if code != 0:
        raise Broken(f'{command[0]}: {said}')
    return said


def disassembled(tools, path, *options):
    """[Instruction], in the order of their addresses; of an archive or object the functions one after the other."""
    found = []
    for line in output(f'{tools}objdump', '-d', '--no-show-raw-insn', *options, path).split('\n'):
        match = re.match(r'\s*([0-9a-f]+):\s+(\S+)\s*(.*)', line)
        if match and not match[2].startswith('.'):
            found.append(Instruction(int(match[1], 16), match[2], match[3]))
    return found


def symbols(tools, path):
    """(file that a local one is of or '', name, address, size) of each function."""
    file = ''
    for line in output(f'{tools}readelf', '-sW', path).split('\n'):
        words = line.split()
        if len(words) < 8 or not words[0].endswith(':'):
            continue
        if words[3] == 'FILE':
            file = words[7]
        elif words[3] == 'FUNC' and words[6] != 'UND' and int(words[2], 0):
            yield (os.path.basename(file) if words[4] == 'LOCAL' else '', words[7], int(words[1], 16) & ~1,
                   int(words[2], 0))


def objects_of(root, build, machine):
    """The port's objects, as (file, path)."""
    found = []
    for path in glob.glob(os.path.join(build, machine.build, '**', '*.obj'), recursive=True):
        match = re.search(rf'/{machine.port}/(\w+\.c)\.obj$', path)
        file = match and f'port/{machine.port}/{match[1]}'
        if match and '/images/' not in path and os.path.exists(os.path.join(root, file)):
            found.append((file, path))
    return sorted(found)


def ways_of(machine, code):
    """{index: (address if not, address if so or None)} of the conditional branches."""
    ways = {}
    for i, (_, name, operands) in enumerate(code[:-1]):
        if CONDITIONAL[machine.kind].match(name):
            target = re.search(r'; 0x([0-9a-f]+)' if machine.kind == 'avr' else r'([0-9a-f]+)( <[^>]*>)?(\s*@.*)?$',
                               operands)
            ways[i] = (code[i + 1].address, int(target[1], 16) if target else None)
        elif machine.kind == 'avr' and SKIPS.match(name) and i + 2 < len(code):
            ways[i] = (code[i + 1].address, code[i + 2].address)
        elif machine.kind == 'arm' and RETURNS.match(name) and (name.startswith('bx') or 'pc' in operands):
            ways[i] = (code[i + 1].address, None)
    return ways


class Port:
    """What the tests have executed of one: {Function: (instructions, executed, ways, taken)}."""

    def __init__(self, root, build, machine):
        self.machine = machine
        self.functions, self.variants = {}, {}
        files = objects_of(root, build, machine)
        if not files and machine.port != 'arduino':
            raise Broken(f'there is no object of port/{machine.port} in {build}')
        self.known = {}  # (file's name or '', name) of a symbol
        for file, path in files:
            for local, name, address, size in symbols(machine.tools, path):
                function = Function(file, name)
                self.known[(local, name)] = function
                self.functions.setdefault(function, None)
            self.count_unlinked(file, path)

    def count_unlinked(self, file, path):
        """One that no image has: so many instructions, none of them executed."""
        text = output(f'{self.machine.tools}objdump', '-d', '--no-show-raw-insn', path)
        for match in re.finditer(r'^[0-9a-f]+ <([^>]+)>:\n((?:[ \t].*\n)+)', text, re.M):
            function = Function(file, match[1])
            if function in self.functions:
                code = [Instruction(int(i[1], 16), i[2], i[3]) for i in
                        re.finditer(r'^\s*([0-9a-f]+):\s+(?!\.)(\S+)[ \t]*(.*)$', match[2], re.M)]
                self.functions[function] = (len(code), 0, 2 * len(ways_of(self.machine, code)), 0)

    def add(self, image, pairs):
        """pairs: {from: {to, ...}} of one image, all its runs."""
        code = disassembled(self.machine.tools, image)
        places = [instruction.address for instruction in code]
        every = list(symbols(self.machine.tools, image))
        starts = {address for _, _, address, _ in every}
        at = {address: i for i, address in enumerate(places)}
        for local, name, address, size in every:
            function = self.known.get((local, name))
            if self.machine.port == 'arduino' and OF_ARDUINO.match(name):
                function = Function('port/arduino/fathom_arduino.cpp', name.split('.')[0])
                self.functions.setdefault(function, None)
            if function is None or address not in at:
                continue
            first = last = at[address]
            while last < len(places) and places[last] < address + size:
                last += 1
            body = code[first:last]
            # The linker may make other instructions of the same function in another image.
            shape = tuple(instruction.name for instruction in body)
            executed, taken = self.variants.setdefault(function, {}).setdefault(shape, (set(), set()))
            ways = ways_of(self.machine, code[first:last + 2])
            for i, instruction in enumerate(body):
                leads = pairs.get(instruction.address)
                if leads is None:
                    continue
                executed.add(i)
                if i in ways:
                    no, yes = ways[i]
                    if no in leads:
                        taken.add((i, False))
                    if (yes in leads) if yes is not None else any(to != no and to not in starts for to in leads):
                        taken.add((i, True))
            length = 2 * sum(i < len(body) for i in ways)
            best = (len(body), len(executed), length, len(taken))
            if self.functions[function] is None or best[1:] >= self.functions[function][1:] or \
                    self.functions[function][1] == 0:
                self.functions[function] = best

    def by_file(self):
        """{file: [functions, reached, instructions, executed, ways, taken]}"""
        rows = {}
        for function, figures in self.functions.items():
            row = rows.setdefault(function.file, [0] * 6)
            figures = figures or (0, 0, 0, 0)
            for i, value in enumerate((1, int(figures[1] > 0), *figures)):
                row[i] += value
        return rows


def traces(folder):
    """{image: {from: {to, ...}}}"""
    result = {}
    for path in glob.glob(os.path.join(folder, '*.trace')):
        with open(path, encoding='utf-8') as file:
            pairs = result.setdefault(os.path.realpath(file.readline().strip()), {})
            for line in file:
                start, to = line.split()
                pairs.setdefault(int(start, 16), set()).add(int(to, 16))
    return result


def record(root, build, folder, jobs, left_out='^$'):
    """Runs the firmware tests, all but those, with their traces into the folder."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    plugin = os.path.join(folder, 'trace.so')
    output('gcc', '-shared', '-fPIC', '-O2', '-o', plugin, os.path.join(root, 'tests', 'firmware', 'qemu', 'trace.c'))
    environment = dict(os.environ, FATHOM_TRACE=folder, FATHOM_TRACE_PLUGIN=plugin)
    # Traces make the longest tests longer, and a machine that has other work may make them too long.
    code, said = run(['ctest', '--test-dir', build, '--parallel', str(jobs), '--no-tests=error', '--output-on-failure',
                      '--repeat', 'after-timeout:3', '--tests-regex', TESTS, '--exclude-regex', left_out],
                     env=environment)
    if code != 0:
        raise Broken(f'a firmware test failed, so that nothing is measured:\n{said[-6000:]}')


def measure(root, build, folder):
    """{file: [functions, reached, instructions, executed, ways, taken]} of what has been recorded."""
    recorded = traces(folder)
    rows = {}
    for machine in MACHINES:
        port = Port(root, build, machine)
        images = os.path.realpath(os.path.join(build, machine.build)) + os.sep
        mine = {path: pairs for path, pairs in recorded.items() if path.startswith(images)}
        if not mine:
            raise Broken(f'no image of {machine.port} has left a trace')
        for path, pairs in sorted(mine.items()):
            port.add(path, pairs)
        rows.update(port.by_file())
    return rows


def build_images(root, folder, jobs):
    """Configures and builds what the firmware tests need, with what they are linked with."""
    environment = dict(os.environ)
    if shutil.which('ccache'):
        environment.update(CMAKE_C_COMPILER_LAUNCHER='ccache')
    if not os.path.exists(os.path.join(folder, 'CMakeCache.txt')):
        code, said = run(['cmake', '--preset', 'gcc', '-S', root, '-B', folder], env=environment)
        if code != 0:
            raise Broken(said)
    # firmware.NAME has a target NAME, which brings all that it needs up to date.
    code, said = run(['ctest', '--test-dir', folder, '--show-only=json-v1', '--tests-regex', TESTS])
    targets = sorted(test['name'].split('.')[1] for test in json.loads(said)['tests'])
    code, said = run(['cmake', '--build', folder, '--parallel', str(jobs), '--target', *targets], env=environment)
    if code != 0:
        raise Broken(f'the images are not built: {said[-4000:]}')
