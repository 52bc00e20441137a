# SPDX-License-Identifier: MIT
"""Finds which functions of the ports for microcontrollers the firmware tests execute, by the addresses that the
simulators write into the folder FATHOM_TRACE."""
import collections
import glob
import json
import os
import re
import shutil

from c_code import Broken, run

Machine = collections.namedtuple('Machine', 'name port tools')
MACHINES = (Machine('avr', 'port/avr', 'avr-'), Machine('arduino', 'port/arduino', 'avr-'),
            Machine('rp2040', 'port/rp2040', 'arm-none-eabi-'), Machine('stm32f4', 'port/stm32f4', 'arm-none-eabi-'),
            Machine('mps2', 'tests/firmware/mps2/port', 'arm-none-eabi-'),
            Machine('virt', 'tests/firmware/virt/port', 'riscv64-unknown-elf-'))
TESTS = '^firmware\\.(test_avr|test_arduino|test_rp2040|stm32f4|mps2|virt)'
# The linker makes the objects of the Arduino library, so its functions are known by their names alone.
OF_ARDUINO = re.compile(r'_ZN6fathom7arduino')


def output(*command):
    code, said = run(list(command))
    if code != 0:
        raise Broken(f'{command[0]}: {said}')
    return said


def symbols(tools, path):
    """Yields (the source of a static function or '', name, address, size) of each function in an object or image."""
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


def images_of(build, machine):
    return os.path.join(build, 'firmware', machine.name)


def functions_of(root, build, machine):
    """Returns {(source of a static function or '', name): (file, name)} of the port's objects."""
    known = {}
    for path in glob.glob(os.path.join(images_of(build, machine), '**', '*.obj'), recursive=True):
        match = re.search(rf'/fathom_{machine.name}\.dir/.*?(\w+\.c)\.obj$', path)
        file = match and f'{machine.port}/{match[1]}'
        if match and os.path.exists(os.path.join(root, file)):
            for local, name, _, _ in symbols(machine.tools, path):
                known[local, name] = (file, name)
    if not known and machine.name != 'arduino':
        raise Broken(f'{build} has no object of {machine.port}')
    return known


def measure(root, build, folder):
    """Returns {(file, function): whether an image executed it} by the traces in the folder."""
    recorded, result = traces(folder), {}
    for machine in MACHINES:
        known = functions_of(root, build, machine)
        result.update(dict.fromkeys(known.values(), False))
        images = os.path.realpath(images_of(build, machine)) + os.sep
        mine = {path: executed for path, executed in recorded.items() if path.startswith(images)}
        if not mine:
            raise Broken(f'no image of {machine.name} has left a trace')
        for path, executed in sorted(mine.items()):
            for local, name, address, size in symbols(machine.tools, path):
                function = known.get((local, name))
                if machine.name == 'arduino' and OF_ARDUINO.match(name):
                    function = ('port/arduino/fathom_arduino.cpp', name.split('.')[0])
                if function:
                    is_reached = any(at in executed for at in range(address, address + size, 2))
                    result[function] = result.get(function, False) or is_reached
    return result


def traces(folder):
    """Returns {image: {address of an executed instruction, ...}}. The first line of a trace is the image. QEMU writes
    the code that it translates, right before it executes it; the name of the file has the image."""
    result = {}
    for path in glob.glob(os.path.join(folder, '*')):
        with open(path, encoding='utf-8') as file:
            of_qemu = re.match(r'qemu-\d+-(.*)', os.path.basename(path))
            image = of_qemu[1].replace('~', '/') if of_qemu else file.readline().strip()
            found = re.findall(r'^0x(\w+):' if of_qemu else r'^\w+$', file.read(), re.M)
        result.setdefault(os.path.realpath(image), set()).update(int(address, 16) for address in found)
    return result


def record(root, build, folder, jobs):
    """Runs the firmware tests, and writes their traces into the folder."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    environment = dict(os.environ, FATHOM_TRACE=folder)
    # Traces make the longest tests longer, and a machine that has other work may make them too long.
    code, said = run(['ctest', '--test-dir', build, '--parallel', str(jobs), '--no-tests=error', '--output-on-failure',
                      '--repeat', 'after-timeout:3', '--tests-regex', TESTS], env=environment)
    if code != 0:
        raise Broken(f'a firmware test failed, so that nothing is measured:\n{said[-6000:]}')


def build_images(root, folder, jobs):
    """Configures and builds what the firmware tests need, with what they are linked with."""
    environment = dict(os.environ)
    if shutil.which('ccache'):
        environment.update(CMAKE_C_COMPILER_LAUNCHER='ccache')
    if not os.path.exists(os.path.join(folder, 'CMakeCache.txt')):
        code, said = run(['cmake', '--preset', 'gcc', '-S', root, '-B', folder], env=environment)
        if code != 0:
            raise Broken(said)
    # firmware.NAME has a target NAME, which builds its image. Some tests also start libmodbus_server.
    code, said = run(['ctest', '--test-dir', folder, '--show-only=json-v1', '--tests-regex', TESTS])
    targets = sorted(test['name'].split('.')[1] for test in json.loads(said)['tests'])
    code, said = run(['cmake', '--build', folder, '--parallel', str(jobs), '--target', *targets, 'libmodbus_server'],
                     env=environment)
    if code != 0:
        raise Broken(f'the images are not built: {said[-4000:]}')
