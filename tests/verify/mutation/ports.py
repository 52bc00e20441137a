# SPDX-License-Identifier: MIT
"""Mutants of the ports that tests on the host are linked with. Their objects are not in a shared library, since some
tests stand in for functions of the system when they are linked; so the programs are linked anew for each."""
import dataclasses
import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import threading

from bench import ROOT, Bench, command

HOST = ('port/posix', 'port/gpio', 'port/serial', 'port/sim', 'port/libmodbus')


@dataclasses.dataclass(frozen=True)
class Unit:
    source: str
    object: str  # relative to the build folder
    words: tuple  # the compiler's
    files: frozenset  # that it is made of

    def archive(self):
        """The library that the object may be a part of, relative to the build folder."""
        place = re.match(r'(.*/)CMakeFiles/(\w+)\.dir/', self.object)
        return f'{place[1]}lib{place[2]}.a'


class PlantedUnits:
    """Programs of tests linked with other objects, when they are first asked for."""

    def __init__(self, build, units, objects, scratch, options=()):
        self.build, self.units, self.objects, self.options = build, units, objects, options
        self.folder = tempfile.mkdtemp(dir=scratch)
        self.environment = {}
        self.made = {}
        self.lock = threading.Lock()

    def program(self, path):
        with self.lock:
            if path not in self.made:
                self.made[path] = self.link(path)
            return self.made[path]

    def link(self, path):
        folder, name = os.path.split(path)
        with open(os.path.join(folder, 'CMakeFiles', f'{name}.dir', 'link.txt'), encoding='utf-8') as file:
            words = shlex.split(file.read())
        before = []
        parts = [os.path.relpath(os.path.join(folder, word), self.build) for word in words]
        for unit, path_of_object in zip(self.units, self.objects):
            if unit.object in parts:
                words[parts.index(unit.object)] = path_of_object
            elif unit.archive() in parts:
                before.append(path_of_object)
        if not before and not set(words) & set(self.objects):
            return path
        target = os.path.join(self.folder, name)
        words[words.index('-o') + 1] = target
        first = words.index('-o')
        command([*words[:first], *before, *words[first:], *self.options], cwd=folder, error=f'{name}: not linked')
        return target


class PortBench(Bench):
    map_name = 'map_of_ports.json'

    def __init__(self, folder, jobs):
        super().__init__(folder, jobs)
        self.units = []

    def files(self):
        """Those of the ports that the tests are made of."""
        return sorted({path for unit in self.units for path in unit.files if path.startswith(HOST)})

    def look(self):
        """What the programs of tests are made of beside the library."""
        with open(os.path.join(self.folder, 'compile_commands.json'), encoding='utf-8') as file:
            entries = json.load(file)
        for entry in entries:
            words = shlex.split(entry['command'])
            output = words[words.index('-o') + 1]
            made = os.path.relpath(os.path.join(entry['directory'], output), self.folder)
            depends = os.path.join(self.folder, made + '.d')
            if not made.startswith(('port/', 'tests/')) or not os.path.exists(depends):
                continue
            with open(depends, encoding='utf-8') as file:
                words_of_it = file.read().replace('\\\n', ' ').split()[1:]
            files = {os.path.relpath(os.path.join(entry['directory'], path), ROOT) for path in words_of_it}
            ports = frozenset(path for path in files if path.startswith('port/'))
            if ports:
                self.units.append(Unit(os.path.relpath(entry['file'], ROOT), made, tuple(words), ports))

    def make_map(self):
        root = os.path.join(self.folder, 'coverage_of_ports')
        shutil.rmtree(root, ignore_errors=True)
        os.makedirs(root)
        # Of a header the lines are executed in what includes it.
        units = [unit for unit in self.units if unit.source.startswith('port/') or
                 any(path.startswith('port/serial/') for path in unit.files)]
        objects = []
        for number, unit in enumerate(units):
            objects.append(os.path.join(root, f'{number}.o'))
            command(self.words(unit, unit.source, objects[-1], ['-O0', '--coverage']), cwd=root)
        return self.cover(root, PlantedUnits(self.folder, units, objects, root, ['--coverage']))

    @staticmethod
    def words(unit, source, target, options, *folders):
        words = [word for word in unit.words if word not in ('-MD',)]
        for option in ('-MT', '-MF', '-o', '-c'):
            if option in words:
                at = words.index(option)
                del words[at:at + 2]
        return [words[0], *(f'-I{folder}' for folder in folders), *words[1:], '-w', *options, '-o', target, '-c',
                os.path.join(ROOT, source)]

    def of(self, mutant):
        return [unit for unit in self.units if mutant.file in unit.files]

    def reached_by(self, mutant):
        found = set()
        for line in range(mutant.first_line, mutant.last_line + 1):
            found |= self.lines.get(mutant.file, {}).get(line, set())
        if not found:
            for unit in self.of(mutant):
                found.update(*self.lines.get(unit.source, {}).values())
        return found

    def compile(self, mutant, text, scratch, options):
        folder = os.path.join(scratch, 'port')
        shutil.rmtree(folder, ignore_errors=True)
        parts = mutant.file.split('/')
        targets = [os.path.join(folder, *parts[first:]) for first in range(1, len(parts))]  # as it may be included
        for target in targets:
            os.makedirs(os.path.dirname(target), exist_ok=True)
            with open(target, 'w', encoding='ascii') as file:
                file.write(text)
        objects = []
        for number, unit in enumerate(self.of(mutant)):
            objects.append(os.path.join(folder, f'{number}.o'))
            source = targets[-1] if unit.source == mutant.file else unit.source
            if source == unit.source and mutant.file.endswith('.h'):
                own = os.path.join(folder, str(number))
                os.makedirs(own)
                source = shutil.copy(os.path.join(ROOT, source), own)  # or it finds the header beside it first
            beside = [folder, os.path.join(ROOT, os.path.dirname(unit.source))]
            done = subprocess.run(self.words(unit, source, objects[-1], options, *beside), stderr=subprocess.DEVNULL,
                                  cwd=folder, check=False)
            if done.returncode != 0:
                return None
        return objects

    def plant(self, mutant, objects, scratch):
        return PlantedUnits(self.folder, self.of(mutant), objects, scratch)
