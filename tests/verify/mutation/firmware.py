# SPDX-License-Identifier: MIT
"""Mutants of the microcontrollers' ports, on their simulators. Each is a change in a copy of the tree that is the
machine's own, an image that is built anew, and the tests of that machine until one fails; so only some are tried."""
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import time

from bench import ROOT, Broken, command
from mutants import mutants_of
from trial import KILLED, NOT_C, SAME_CODE, SURVIVED, Result

COPIED = ('CMakeLists.txt', 'LICENSE', 'README.md', 'examples', 'include', 'port', 'src', 'tests')
CONFIGURE = ['-DCMAKE_BUILD_TYPE=Release', '-DFATHOM_TESTS=ALL', '-DFATHOM_FIRMWARE=ON', '-DFATHOM_STRICT=OFF',
             '-DFATHOM_CHECKS=OFF', '-DFATHOM_INSTALL=OFF']
# What libclang calls what each compiler builds for.
TARGETS = {'avr': 'avr', 'rp2040': 'arm-none-eabi', 'stm32f4': 'arm-none-eabi', 'virt': 'riscv32'}
# The folder of each port: what only a test machine has stands with the tests.
FOLDERS = {'avr': 'port/avr', 'rp2040': 'port/rp2040', 'stm32f4': 'port/stm32f4',
           'virt': 'tests/firmware/virt/port'}
LIMIT_S = 60
MOST_OF_USUAL = 4


def machine_of(test):
    """Whose test of tests/firmware it is, by its name: test_avr_uart, virt_alone."""
    found = re.match(r'(?:test_)?([a-z0-9]+)_', test)
    return found[1] if found else ''


class Machine:
    def __init__(self, name, folder):
        self.name = name
        self.root = os.path.join(folder, name)
        self.build = os.path.join(self.root, 'build')
        self.images = os.path.join(self.build, 'firmware', name, 'images')
        self.tests = {}  # seconds, by name

    def prepare(self):
        """False where the machine has no test that passes: its tools may be missing."""
        os.makedirs(self.root)
        for name in COPIED:
            source, target = os.path.join(ROOT, name), os.path.join(self.root, name)
            if os.path.isdir(source):
                shutil.copytree(source, target, ignore=shutil.ignore_patterns('__pycache__', '*.patch'))
            else:
                shutil.copy(source, target)
        env = {**os.environ, 'CMAKE_EXPORT_COMPILE_COMMANDS': 'ON'}  # the images are configured when they are built
        command(['cmake', '-S', self.root, '-B', self.build, *CONFIGURE], error=f'{self.name}: not configured', env=env)
        listed = command(['ctest', '-N', '-L', 'firmware'], cwd=self.build)
        names = [name for name in re.findall(r': firmware\.(\w+)$', listed, re.M) if machine_of(name) == self.name]
        if not names:
            return False
        command(['cmake', '--build', self.build, '--target', *names, 'libmodbus_server'],
                error=f'{self.name}: not built', env=env)
        for name in names:
            began = time.monotonic()
            if self.fails(name, 4 * LIMIT_S):
                print(f'firmware.{name} fails without a mutant, and is left out')
            else:
                self.tests[name] = time.monotonic() - began
        return bool(self.tests)

    def fails(self, test, limit_s):
        words = ['ctest', '-R', rf'^firmware\.{test}$', '--timeout', str(round(limit_s)), '--no-tests=error']
        done = subprocess.run(words, cwd=self.build, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False,
                              stdin=subprocess.DEVNULL, env={**os.environ, 'FATHOM_FIRST_FAILURE': '1'})
        return done.returncode != 0

    def mutants(self):
        """Of the files that its images are made of."""
        with open(os.path.join(self.build, 'firmware', self.name, 'compile_commands.json'), encoding='utf-8') as file:
            entries = json.load(file)
        found = []
        for entry in entries:
            path = os.path.relpath(entry['file'], self.root)
            if path.startswith(FOLDERS[self.name] + '/'):
                found += mutants_of(path, ROOT, self.arguments(entry))
        return found

    def arguments(self, entry):
        """What libclang has to be told to read a file as the machine's compiler does."""
        words = shlex.split(entry['command'])
        machine = [word for word in words if word.startswith(('-mmcu', '-mcpu', '-mthumb', '-ffreestanding'))]
        said = subprocess.run([words[0], *machine, '-x', 'c', '-E', '-v', '/dev/null'], stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, check=True).stderr
        folders = re.findall(r'^ (/\S+)$', said.partition('search starts here:')[2], re.M)
        mine = [word.replace(self.root, ROOT) for word in words if word.startswith(('-I', '-D'))]
        return [f'--target={TARGETS[self.name]}', '-std=c99', *machine, *mine, *(f'-isystem{path}' for path in folders)]

    def digest(self):
        digest = hashlib.sha256()
        for name in sorted(os.listdir(self.images)):
            with open(os.path.join(self.images, name), 'rb') as file:
                digest.update(name.encode() + file.read())
        return digest.hexdigest()

    def attempt(self, mutant, original):
        began = time.monotonic()
        path = os.path.join(self.root, mutant.file)
        with open(path, encoding='ascii') as file:
            text = file.read()
        try:
            with open(path, 'w', encoding='ascii') as file:
                file.write(mutant.applied(text))
            try:
                command(['cmake', '--build', self.build, '--target', f'firmware_{self.name}'])
            except Broken:
                return Result(mutant, NOT_C)
            if self.digest() == original:
                return Result(mutant, SAME_CODE)
            stem = os.path.splitext(os.path.basename(mutant.file))[0].rstrip('0123456789')
            for count, test in enumerate(sorted(self.tests, key=lambda test: (stem not in test, self.tests[test])), 1):
                if self.fails(test, LIMIT_S + MOST_OF_USUAL * self.tests[test]):
                    return Result(mutant, KILLED, f'firmware.{test}', 'fails', count, time.monotonic() - began)
            return Result(mutant, SURVIVED, tests=len(self.tests), seconds=time.monotonic() - began)
        finally:
            with open(path, 'w', encoding='ascii') as file:
                file.write(text)


def results(name, folder, sample):
    """Of some mutants of a machine's port, which sample chooses from all; None where it has no test that passes."""
    machine = Machine(name, folder)
    if not machine.prepare():
        return None
    original = machine.digest()
    return [machine.attempt(mutant, original) for mutant in sample(machine.mutants())]
