# SPDX-License-Identifier: MIT
"""What mutants are tried on: the tests, built once and linked with a shared library, and a map that says which of them
execute which lines. A mutant is one object in a library of its own, which the loader puts before the other."""
import concurrent.futures
import dataclasses
import glob
import hashlib
import json
import os
import re
import select
import shutil
import signal
import subprocess
import time

from syntax import LAYERS, library

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
KINDS = ('unit', 'devices', 'port')
IN_REAL_TIME = ('port',)  # its results may depend on the load of the machine
TWINS = {'src/codec/crc16_small.c': 'src/codec/crc16.c'}  # linked in the place of
CONFIGURE = ['-DCMAKE_BUILD_TYPE=Release', '-DBUILD_SHARED_LIBS=ON', '-DFATHOM_EXAMPLES=OFF', '-DFATHOM_STRICT=OFF',
             '-DFATHOM_CHECKS=OFF', '-DFATHOM_INSTALL=OFF', '-DCMAKE_EXPORT_COMPILE_COMMANDS=ON']
COMPILER = os.environ.get('CC', 'gcc')
FLAGS = ['-std=c99', '-fPIC', '-w', '-pipe']
HASHED = ('CMakeLists.txt', 'README.md', 'include', 'src', 'port', 'examples', 'tests')
LEAST_LIMIT_S, MOST_OF_USUAL = 0.5, 5  # of the processor
LEAST_WALL_S = 15  # of the clock, for one that waits


class Broken(Exception):
    """It cannot be tried at all."""


@dataclasses.dataclass(frozen=True, order=True)
class Test:
    kind: str
    program: str  # relative to the build folder
    names: tuple  # of its source files that are to run; none: all

    def __str__(self):
        return ' '.join([os.path.basename(self.program), *self.names])


def command(words, cwd=None, error='', env=None):
    done = subprocess.run(words, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          env=env)
    if done.returncode != 0:
        found = [line for line in done.stdout.splitlines() if re.search('error|FAILED|undefined', line)]
        raise Broken('\n    '.join([error or ' '.join(words[:3]), *found[:5]]))
    return done.stdout


def processor_s(pid):
    """What the process and those it has waited for have used so far."""
    try:
        with open(f'/proc/{pid}/stat', encoding='ascii', errors='replace') as file:
            fields = file.read().rpartition(')')[2].split()
        return sum(int(field) for field in fields[11:15]) / os.sysconf('SC_CLK_TCK')
    except OSError:
        return 0.0


class Bench:
    def __init__(self, folder, jobs):
        self.folder = folder
        self.jobs = jobs
        self.tests = []
        self.seconds = {}  # by test
        self.lines = {}  # {file: {line: {test, ...}}}
        self.originals = {}  # their objects, by (file, options)

    # ---- what is built once ----

    def prepare(self, say=print):
        began = time.time()
        command(['cmake', '-S', ROOT, '-B', self.folder, f'-DCMAKE_C_COMPILER={COMPILER}', *CONFIGURE],
                error='not configured')
        self.tests = self.find_tests()
        targets = sorted({os.path.basename(test.program) for test in self.tests})
        command(['cmake', '--build', self.folder, '-j', str(self.jobs), '--target', *targets], error='not built')
        say(f'{len(self.tests)} tests in {len(targets)} programs, built in {time.time() - began:.0f} s')
        self.read_map(say)

    def find_tests(self):
        """Returns the tests of KINDS, which are programs in C, from the files that ctest reads."""
        found = []
        for where, _, names in os.walk(os.path.join(self.folder, 'tests')):
            if 'CTestTestfile.cmake' not in names:
                continue
            with open(os.path.join(where, 'CTestTestfile.cmake'), encoding='utf-8') as file:
                listed = re.findall(r'^add_test\(\[?=?\[?(\w+)\.\w+\]?=?\]? (.*)\)$', file.read(), re.M)
            for kind, words in listed:
                program, *names_of_tests = re.findall(r'"([^"]*)"', words)
                program = os.path.relpath(program, self.folder)
                if kind in KINDS and program.startswith('tests'):
                    found.append(Test(kind, program, tuple(names_of_tests)))
        missing = set(KINDS) - {test.kind for test in found}
        if missing:
            raise Broken(f'{self.folder} registers no test of the kind {" ".join(sorted(missing))}')
        return sorted(found)

    def key(self):
        """A hash of all that the map depends on."""
        digest = hashlib.sha256(repr((COMPILER, FLAGS)).encode())
        for name in HASHED:
            top = os.path.join(ROOT, name)
            paths = [top] if os.path.isfile(top) else sorted(
                path for path in glob.glob(os.path.join(top, '**'), recursive=True)
                if os.path.isfile(path) and path.endswith(('.c', '.h', 'CMakeLists.txt', '.csv')))
            for path in paths:
                with open(path, 'rb') as file:
                    digest.update(path.encode() + file.read())
        return digest.hexdigest()

    def read_map(self, say):
        path, key = os.path.join(self.folder, 'map.json'), self.key()
        stored = {}
        if os.path.exists(path):
            with open(path, encoding='utf-8') as file:
                stored = json.load(file)
        if stored.get('key') != key:
            began = time.time()
            stored = {'key': key, 'tests': self.make_map()}
            with open(path, 'w', encoding='utf-8') as file:
                json.dump(stored, file)
            say(f'a map of the lines that each test executes, in {time.time() - began:.0f} s')
        for test in self.tests:
            of_test = stored['tests'][str(test)]
            self.seconds[test] = of_test['seconds']
            for name, lines in of_test['lines'].items():
                for line in lines:
                    self.lines.setdefault(name, {}).setdefault(line, set()).add(test)

    def make_map(self):
        root = os.path.join(self.folder, 'coverage')
        shutil.rmtree(root, ignore_errors=True)
        os.makedirs(root)
        sources = [os.path.join(ROOT, path) for path in library(ends='.c') if path not in TWINS]
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            list(pool.map(lambda path: command(
                [COMPILER, *FLAGS, '-O0', '--coverage', f'-I{ROOT}/include', '-c', path,
                 '-o', os.path.join(root, os.path.basename(path)[:-2] + '.o')], cwd=root), sources))
            covered = os.path.join(root, 'covered.so')
            command([COMPILER, '-shared', '--coverage', '-o', covered, *glob.glob(os.path.join(root, '*.o'))])
            found = pool.map(lambda test: self.covered(test, root, covered), self.tests)
            return dict(zip(map(str, self.tests), found))

    def covered(self, test, root, planted):
        """How long a test takes, on code as little optimised as that of most mutants, and which lines it executes."""
        folder = os.path.join(root, re.sub(r'\W+', '_', str(test)))
        os.makedirs(folder)
        outcome, seconds = self.run(test, planted, 120, 240, {'GCOV_PREFIX': folder, 'GCOV_PREFIX_STRIP': '99'})
        if outcome:
            raise Broken(f'without a mutant: {test} {outcome}')
        data = sorted(glob.glob(os.path.join(folder, '*.gcda')))
        for path in data:
            name = os.path.basename(path)[:-5] + '.gcno'
            os.symlink(os.path.join(root, name), os.path.join(folder, name))
        lines = {}
        if data:
            for text in command(['gcov', '--json-format', '--stdout', *data], cwd=folder).splitlines():
                for file in json.loads(text)['files']:
                    name = os.path.relpath(os.path.join(root, file['file']), ROOT)
                    if name.startswith(('src/', 'port/')):
                        found = lines.setdefault(name, set())
                        found.update(line['line_number'] for line in file['lines'] if line['count'])
        shutil.rmtree(folder)
        return {'seconds': seconds, 'lines': {name: sorted(found) for name, found in lines.items()}}

    # ---- a mutant ----

    def reached_by(self, mutant):
        """The tests that execute its lines; all that execute the file, where none of them has code."""
        lines = self.lines.get(TWINS.get(mutant.file, mutant.file), {})
        found = set()
        if mutant.file not in TWINS:
            for line in range(mutant.first_line, mutant.last_line + 1):
                found |= lines.get(line, set())
        if not found:
            for name in (self.users(mutant.file) if mutant.file.endswith('.h') else [mutant.file]):
                found.update(*self.lines.get(TWINS.get(name, name), {}).values())
        return found

    @staticmethod
    def users(header):
        """The sources of the library that include a header of its own, through others too."""
        found, files = {header}, {}
        for path in library():
            with open(os.path.join(ROOT, path), encoding='utf-8') as file:
                files[path] = {os.path.normpath(os.path.join(os.path.dirname(path), name))
                               for name in re.findall(r'^#include "((?:\.\./)?\w+\.h)"', file.read(), re.M)}
        while True:
            more = {path for path, included in files.items() if included & found} - found
            if not more:
                return sorted(path for path in found if path.endswith('.c'))
            found |= more

    def compile(self, mutant, text, scratch, options):
        """The objects of a file with this text in the place of its own; None when it is not C."""
        shutil.rmtree(os.path.join(scratch, 'src'), ignore_errors=True)
        for folder in ('src', *LAYERS):
            os.makedirs(os.path.join(scratch, folder))
        sources = self.users(mutant.file) if mutant.file.endswith('.h') else [mutant.file]
        for name in sources:
            if name != mutant.file:
                shutil.copy(os.path.join(ROOT, name), os.path.join(scratch, name))
        with open(os.path.join(scratch, mutant.file), 'w', encoding='ascii') as file:
            file.write(text)
        objects = []
        for name in sources:
            target = os.path.join(scratch, name[:-2] + '.o')
            words = [COMPILER, *FLAGS, *options, f'-I{ROOT}/include', *(f'-I{ROOT}/{layer}' for layer in LAYERS),
                     '-c', name]
            done = subprocess.run([*words, '-o', target], cwd=scratch, stderr=subprocess.DEVNULL, check=False)
            if done.returncode != 0:
                return None
            objects.append(target)
        return objects

    @staticmethod
    def contents(objects):
        found = []
        for path in objects:
            with open(path, 'rb') as file:
                found.append(file.read())
        return found

    @staticmethod
    def plant(objects, scratch):
        """Returns the mutant's library, which the loader puts before the other."""
        path = os.path.join(scratch, 'mutant.so')
        command(['ld', '-shared', '-o', path, *objects])
        return path

    def limits_s(self, test):
        """Of the processor, and of the clock; the machine may be busy with others."""
        usual = MOST_OF_USUAL * self.seconds[test]
        return LEAST_LIMIT_S + usual, LEAST_WALL_S + (usual if test.kind in IN_REAL_TIME else 4 * usual)

    def run(self, test, planted, processor_limit_s, wall_limit_s, environment=None):
        """(None when it passes, else how it fails; seconds of the processor, or of the clock for one in real time)"""
        env = {**os.environ, 'FATHOM_FIRST_FAILURE': '1', 'LD_PRELOAD': planted, **(environment or {})}
        program = os.path.join(self.folder, test.program)
        began = time.monotonic()
        process = subprocess.Popen([program, *test.names], env=env, stdin=subprocess.DEVNULL,
                                   cwd=os.path.join(self.folder, os.path.dirname(test.program)),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        handle = os.pidfd_open(process.pid)
        hangs = True
        try:
            ready = select.poll()
            ready.register(handle, select.POLLIN)
            while hangs and time.monotonic() - began < wall_limit_s and processor_s(process.pid) < processor_limit_s:
                hangs = not ready.poll(100)
        finally:
            os.close(handle)
            try:
                os.killpg(process.pid, signal.SIGKILL)  # one that fails may leave a child behind
            except ProcessLookupError:
                pass
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        how = 'hangs' if hangs else 'crashes' if process.returncode < 0 else 'fails' if process.returncode else None
        wall_s = time.monotonic() - began
        return how, wall_s if test.kind in IN_REAL_TIME else used.ru_utime + used.ru_stime
