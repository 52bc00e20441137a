# SPDX-License-Identifier: MIT
"""Plants rows in programs and images that are built once, and runs the tests on them."""
import concurrent.futures
import json
import os
import queue
import re
import signal
import subprocess
import tempfile

from planted import Bad
from relink import Build, Overlay, command

KINDS = ('unit', 'golden', 'property', 'port', 'sim', 'libmodbus')
# A case; by cmocka, the runner in JavaScript, unittest.
FAILED = r'^(?:\[  FAILED  \]|FAILED|FAIL:|ERROR:) +(\w+.*)$'
LIMIT_S = 60  # for one test that a row names
LONG_LIMIT_S = 120  # for all the others of one program
CONFIGURE = ['-G', 'Unix Makefiles', '-DCMAKE_BUILD_TYPE=Debug', '-DCMAKE_C_FLAGS_DEBUG=-O1', '-DFATHOM_STRICT=OFF',
             '-DFATHOM_CHECKS=OFF', '-DFATHOM_INSTALL=OFF', '-DCMAKE_C_COMPILER=' + os.environ.get('CC', 'gcc')]


def failure(name, words, cwd, environment, limit_s):
    """What a test says; None when it passes."""
    with tempfile.TemporaryFile('w+', errors='replace') as output:
        environment = {**os.environ, 'FATHOM_FIRST_FAILURE': '1', **environment}
        test = subprocess.Popen(words, cwd=cwd, env=environment, stdin=subprocess.DEVNULL, stdout=output,
                                stderr=subprocess.STDOUT, start_new_session=True)
        try:
            status = test.wait(limit_s)
        except subprocess.TimeoutExpired:
            status = None
        finally:
            try:
                os.killpg(test.pid, signal.SIGKILL)  # a test that failed may leave a child behind
            except ProcessLookupError:
                pass
            test.wait()
        output.seek(0)
        failed = re.search(FAILED, output.read(), re.M)
    if status == 0:
        return None
    how = ', which hangs' if status is None else ', which crashes' if status < 0 else ''
    return f'{name}: {failed[1]}{how}' if failed else f'{name}{how or ", before its first case"}'


class Test:
    """As ctest would run it."""

    def __init__(self, told, build):
        self.kind, _, name = told['name'].partition('.')
        self.name, self.words = f'{self.kind}/{name}', told.get('command')
        properties = {each['name']: each['value'] for each in told.get('properties', ())}
        self.environment = dict(pair.split('=', 1) for pair in properties.get('ENVIRONMENT', ()))
        self.cwd = properties.get('WORKING_DIRECTORY', build)

    def run(self, program=None, images=None, limit_s=LIMIT_S):
        """With another program in the place of its own, or (where they were, where they are) images."""
        words, environment = [program, *self.words[1:]] if program else self.words, self.environment
        if images:
            def moved(text):
                return text.replace(*images)
            words, environment = map(moved, words), {name: moved(text) for name, text in environment.items()}
            environment['FATHOM_IMAGES'] = images[1]
        return failure(self.name, list(words), self.cwd, environment, limit_s)


class Planter:
    """Plants one row after the other, in an overlay of its own."""

    def __init__(self, run, folder):
        self.run, self.folder = run, folder
        self.overlay = Overlay(run.root, folder)

    def plant(self, row):
        try:
            self.overlay.change(row.changed(self.run.root))
            return self.firmware(row) if row.is_firmware else self.host(row)
        finally:
            self.overlay.restore()

    def firmware(self, row):
        machine = row.machine()
        there, here = self.run.images(machine), os.path.join(self.folder, 'images', machine)
        if machine == 'arduino':
            here = self.overlay.sketches(here)
        else:
            self.overlay.images(self.run.builds[machine], here)
        return next(filter(None, (self.run.tests[name].run(images=(there, here)) for name in row.tests)), None)

    def host(self, row):
        build, linked = self.run.builds[''], {}

        def program_of(test):
            name = test.words[0]
            if name not in linked:
                linked[name] = self.overlay.link(build, name)
            return linked[name]

        for name in row.tests:
            test = self.run.tests[name]
            program = program_of(test)
            seen = program and test.run(program)
            if seen:
                return seen
        others = {}  # program: all its tests but those of the row
        for test in self.run.tests.values():
            if test.kind in KINDS and test.name not in row.tests:
                others.setdefault(test.words[0], []).append(test)
        for tests in others.values():
            program = program_of(tests[0])
            arguments = [word for test in tests for word in test.words[1:]]
            seen = program and failure(os.path.basename(program), [program, *arguments], tests[0].cwd, {},
                                       LONG_LIMIT_S)
            if seen:
                return f'{seen} (not by {" ".join(row.tests)})'
        if not any(linked.values()):
            raise Bad('no program is made of what it changes')
        return None


class Run:
    """The build and its tests, and the rows that can be planted in it."""

    def __init__(self, root, rows, folder, build, as_built):
        self.root, self.build = root, os.path.abspath(build) if build else os.path.join(folder, 'build')
        with_firmware = any(row.is_firmware for row in rows)
        if not build:
            command(['cmake', '-S', root, '-B', self.build, *CONFIGURE,
                     f'-DFATHOM_FIRMWARE={"ON" if with_firmware else "OFF"}'], root, 'not configured')
        if not as_built:
            command(['cmake', '--build', self.build, '--parallel', str(os.cpu_count()), '--target',
                     *(self.targets(rows) or ['help'])], root, 'the tests do not compile')
        told = json.loads(command(['ctest', '--show-only=json-v1'], self.build, 'ctest does not list the tests'))
        tests = [Test(each, self.build) for each in told['tests']]
        self.tests = {test.name: test for test in tests if test.words and test.kind in (*KINDS, 'firmware')}
        self.rows = [row for row in rows if all(name in self.tests for name in row.tests)]
        self.left_out = [row for row in rows if row not in self.rows]
        if not as_built:
            named = [self.tests[name] for name in dict.fromkeys(name for row in self.rows for name in row.tests)]
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                seen = next(filter(None, pool.map(lambda test: test.run(limit_s=LONG_LIMIT_S), named)), None)
            if seen:
                raise Bad(f'without a fault: {seen} fails')
        self.builds = {'': Build(self.build)}
        for machine in {row.machine() for row in self.rows if row.is_firmware} - {'arduino'}:
            self.builds[machine] = Build(os.path.join(self.build, 'firmware', machine))

    def targets(self, rows):
        """What the rows' tests are built by: for the host all programs of tests, by the files that ctest reads."""
        wanted = {name.replace('/', '.') for row in rows for name in row.tests}
        targets = {}
        for where, _, names in os.walk(self.build):
            for name in set(names) & {'CTestTestfile.cmake'}:
                with open(os.path.join(where, name), encoding='utf-8') as file:
                    for test, program in re.findall(r'^add_test\(\W*([\w.]+)\W+ "([^"]+)"', file.read(), re.M):
                        kind, _, name_of_test = test.partition('.')
                        if kind in KINDS and not all(row.is_firmware for row in rows):
                            targets[os.path.basename(program)] = None
                        elif kind == 'firmware' and test in wanted:
                            targets[name_of_test] = None
        return list(targets)

    def images(self, machine):
        return os.path.join(self.build, 'firmware', machine, 'images')


def plant_all(run, folder, jobs):
    """Plants the rows in threads, prints a line for each, in order; returns how many were not seen."""
    results = {row.name: concurrent.futures.Future() for row in run.rows}
    rest = queue.SimpleQueue()
    for row in sorted(run.rows, key=lambda row: not row.name.startswith('port_')):  # the slow ones first
        rest.put(row)

    def work(number):
        planter = Planter(run, os.path.join(folder, str(number)))
        while True:
            try:
                row = rest.get_nowait()
            except queue.Empty:
                return
            try:
                results[row.name].set_result((planter.plant(row), ''))
            except (Bad, OSError) as error:
                results[row.name].set_result((None, str(error).rstrip()))
            except Exception as error:  # of this program: raised where the result is waited for
                results[row.name].set_exception(error)

    missed = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        workers = pool.map(work, range(jobs))
        for row in run.rows:
            seen, why = results[row.name].result()
            if seen is None:
                missed += 1
                why = why or f'no test sees it ({row.promise})'
            print(f'{row.name}: {f"seen by {seen}" if seen else f"FAILED, {why}"}', flush=True)
        list(workers)
    return missed


def run_rows(root, rows, jobs, build=None, as_built=False):
    """Returns the exit status."""
    with tempfile.TemporaryDirectory(prefix='fathom-planted.') as folder:
        run = Run(root, rows, folder, build, as_built)
        for row in run.left_out:
            print(f'{row.name}: left out, the tools for {" ".join(row.tests)} are not there')
        missed = plant_all(run, folder, max(1, min(jobs, len(run.rows))))
    print(f'{len(run.rows) - missed} passed, {missed} failed')
    return 1 if missed or not run.rows else 0
