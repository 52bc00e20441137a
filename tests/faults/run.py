#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plants faults in a copy of the sources, one at a time, and sees that a test finds each.

    run.py [--list] [-j N] [NAME ...]

A fault is a file NNN-NAME.patch: a line that says what is broken, "Promise: " and what it breaks, "Seen by: "
and the test programs that are expected to find it, then a unified diff with one line of context. Those programs
run first, and only if they pass do all the others of the kinds below. A fault is missed when all pass; a file
that does not apply any more, or does not compile, is a failure too. NAME: only the faults whose names have it.
Where libmodbus is missing the port over it is not built, and its faults are left out.
A program firmware/NAME is the test firmware.NAME of tests/firmware, whose images are built for it. All faults of one
machine go to the same copy, so that no other one builds it; where its tools are missing they are left out."""
import argparse
import concurrent.futures
import glob
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
COPIED = ('CMakeLists.txt', 'LICENSE', 'README.md', 'examples', 'include', 'port', 'src', 'tests')
HAS_LIBMODBUS = shutil.which('pkg-config') is not None and \
    subprocess.run(['pkg-config', '--exists', 'libmodbus'], check=False).returncode == 0
FIRMWARE = 'firmware/'
KINDS = ('unit', 'golden', 'property', 'port', 'sim') + (('libmodbus',) if HAS_LIBMODBUS else ())
FAILED = r'^(?:\[  FAILED  \]|FAILED|FAIL:|ERROR:) +(\w+.*)$'  # a case; by cmocka, the runner in JavaScript, unittest
LIMIT_S = 20  # for one test program that a fault names
LONG_LIMIT_S = 90  # for one of all the others
CONFIGURE = ['-DCMAKE_BUILD_TYPE=Debug', '-DCMAKE_C_FLAGS_DEBUG=-O1', '-DFATHOM_STRICT=OFF', '-DFATHOM_CHECKS=OFF',
             '-DFATHOM_INSTALL=OFF', '-DCMAKE_C_COMPILER=' + os.environ.get('CC', 'gcc')]


def machines():
    """The folder in tests/firmware that each of its tests is in; test_NAME.py for QEMU is MACHINE_NAME to ctest."""
    found = {}
    for path in glob.glob(os.path.join(ROOT, 'tests', FIRMWARE, '*', 'test_*')):
        machine = os.path.basename(os.path.dirname(path))
        name = os.path.splitext(os.path.basename(path))[0]
        found[FIRMWARE + name] = found[FIRMWARE + name.replace('test', machine, 1)] = machine
    return found


MACHINES = machines()


class Broken(Exception):
    """Not a fault that was missed, but one that could not be tried."""


class Fault:
    def __init__(self, file_name):
        self.name = file_name.removesuffix('.patch')
        self.path = os.path.join(HERE, file_name)
        with open(self.path, encoding='utf-8') as file:
            head, _, diff = file.read().partition('\n--- a/')
        found = re.fullmatch(r'(.+)\nPromise: (.+)\nSeen by: (.+)\n', head)
        if not found or not diff:
            raise SystemExit(f'{file_name}: not the form that run.py --help tells')
        self.what, self.promise = found[1], found[2]
        seen_by = found[3].split()
        self.firmware = [name for name in seen_by if name.startswith(FIRMWARE)]
        self.programs = [name for name in seen_by if name not in self.firmware]
        unknown = [name for name in self.firmware if name not in MACHINES]
        if unknown:
            raise SystemExit(f'{file_name}: there is no {" ".join(unknown)}')
        self.machine = MACHINES[self.firmware[0]] if self.firmware else None
        self.files = re.findall(r'^--- a/(\S+)', '\n--- a/' + diff, re.M)

    def can_be_built(self):
        return HAS_LIBMODBUS or not any(name.startswith('port/libmodbus/') for name in self.files)


class Copy:
    """A copy of the sources with a build folder."""

    def __init__(self, root, with_firmware):
        self.root = root
        self.build_root = os.path.join(root, 'build')
        os.makedirs(root)
        for name in COPIED:
            source, target = os.path.join(ROOT, name), os.path.join(root, name)
            if os.path.isdir(source):
                shutil.copytree(source, target, ignore=shutil.ignore_patterns('*.patch', '__pycache__'))
            else:
                shutil.copy(source, target)
        folders = {kind: os.path.join(root, 'tests', kind) for kind in KINDS}
        kinds = {name[:-2]: kind for kind in KINDS for name in sorted(os.listdir(folders[kind]))
                 if name.startswith('test_') and name.endswith('.c')}
        self.programs = list(kinds)
        switch = 'ON' if with_firmware else 'OFF'  # the tool is the far end of some
        self.command(['cmake', '-S', root, '-B', self.build_root, *CONFIGURE, f'-DFATHOM_FIRMWARE={switch}',
                      f'-DFATHOM_EXAMPLES={switch}'], 'not configured')
        targets = os.path.join(self.build_root, 'tests', 'CMakeFiles')
        self.targets = {name: name if os.path.isdir(os.path.join(targets, name + '.dir')) else 'test_' + kind
                        for name, kind in kinds.items()}  # a test is a program of its own, or in that of its kind
        self.build(self.programs)

    def firmware_tests(self):
        """Those that this system has the tools for."""
        listed = subprocess.run(['ctest', '-N', '-L', 'firmware'], cwd=self.build_root, stdout=subprocess.PIPE, text=True,
                                check=True).stdout
        return {FIRMWARE + name for name in re.findall(r': firmware\.(\w+)$', listed, re.M)}

    def command(self, command, words):
        done = subprocess.run(command, cwd=self.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False)
        if done.returncode != 0:
            errors = [line for line in done.stdout.splitlines() if re.search('error|FAILED|undefined', line)]
            raise Broken('\n    '.join([words, *errors[:5]]))

    def build(self, programs):
        targets = {self.targets.get(name, name.removeprefix(FIRMWARE)): None for name in programs} or ['help']
        self.command(['cmake', '--build', self.build_root, '--target', *targets], 'it does not compile')

    def seen_by(self, program, limit_s):
        """What the test program says against the sources as they are; None when it passes."""
        command = [os.path.join(self.build_root, 'tests', self.targets.get(program, '')), program]
        if program.startswith(FIRMWARE):
            name = program.removeprefix(FIRMWARE)
            command = ['ctest', '--output-on-failure', '--no-tests=error', '-R', rf'^firmware\.{name}$']
        with tempfile.TemporaryFile('w+', errors='replace') as output:
            test = subprocess.Popen(command, cwd=self.build_root, stdin=subprocess.DEVNULL, stdout=output,
                                    stderr=subprocess.STDOUT, start_new_session=True,
                                    env={**os.environ, 'FATHOM_FIRST_FAILURE': '1'})
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
        return f'{program}: {failed[1]}{how}' if failed else f'{program}{how or ", before its first case"}'

    def first_seen_by(self, programs, limit_s=LONG_LIMIT_S):
        return next(filter(None, (self.seen_by(program, limit_s) for program in programs)), None)

    def plant(self, fault):
        """Who sees the fault; the sources are as before afterwards."""
        unknown = [program for program in fault.programs if program not in self.programs]
        if unknown:
            raise Broken(f'there is no {" ".join(unknown)}')
        kept = {}
        for name in fault.files:
            with open(os.path.join(self.root, name), 'rb') as file:
                kept[name] = file.read()
        try:
            self.command(['patch', '-p1', '--fuzz=0', '--no-backup-if-mismatch', '--reject-file=-', '-i', fault.path],
                         'the patch does not apply any more')
            self.build(fault.programs + fault.firmware)
            seen = self.first_seen_by(fault.programs + fault.firmware, LIMIT_S)
            if seen is None and not fault.firmware:
                self.build(self.programs)
                seen = self.first_seen_by(p for p in self.programs if p not in fault.programs)
                seen = seen and f'{seen} (not by {" ".join(fault.programs)})'
            return seen
        finally:
            for name, content in kept.items():
                with open(os.path.join(self.root, name), 'wb') as file:
                    file.write(content)


def shares(faults, count):
    """The faults of firmware in so many lists, each machine in one of them."""
    lists = [[] for _ in range(count)]
    by_machine = {}
    for fault in faults:
        if fault.machine:
            by_machine.setdefault(fault.machine, []).append(fault)
    for group in sorted(by_machine.values(), key=len, reverse=True):
        min(lists, key=len).extend(group)
    return lists


def see_without_fault(copy, programs, faults):
    """A test that fails although nothing is planted, or None. Builds what is still missing."""
    firmware = sorted({name for fault in faults for name in fault.firmware})
    copy.build(firmware)
    return copy.first_seen_by(programs + firmware)


def try_all(faults, copies, own):
    """Prints a line a fault, in order; returns how many were not seen. own: what each copy begins with."""
    rest = queue.SimpleQueue()
    for fault in faults:
        if not fault.machine:
            rest.put(fault)
    results = {fault.name: concurrent.futures.Future() for fault in faults}

    def attempt(copy, fault):
        try:
            results[fault.name].set_result((copy.plant(fault), ''))
        except (Broken, OSError) as error:
            results[fault.name].set_result((None, str(error).rstrip()))
        except Exception as error:  # of this program: raised where the result is waited for
            results[fault.name].set_exception(error)

    def work(copy, own_faults):
        for fault in own_faults:
            attempt(copy, fault)
        while True:
            try:
                fault = rest.get_nowait()
            except queue.Empty:
                return
            attempt(copy, fault)

    missed = 0
    with concurrent.futures.ThreadPoolExecutor(len(copies)) as pool:
        workers = pool.map(work, copies, own)
        for fault in faults:
            seen, why = results[fault.name].result()
            if seen is None:
                missed += 1
                why = why or f'no test sees it ({fault.what})'
            print(f'{fault.name}: {f"seen by {seen}" if seen else f"FAILED, {why}"}', flush=True)
        list(workers)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--list', action='store_true', help='only list the faults')
    parser.add_argument('-j', '--jobs', type=int, default=min(4, os.cpu_count() or 1), help='copies that work at once')
    parser.add_argument('names', nargs='*', metavar='NAME', help='a part of the name of the faults to plant')
    options = parser.parse_args()
    faults = [Fault(name) for name in sorted(os.listdir(HERE)) if name.endswith('.patch')]
    faults = [f for f in faults if not options.names or any(name in f.name for name in options.names)]
    missing = [f.name for f in faults if not f.can_be_built()]
    faults = [f for f in faults if f.can_be_built()]
    if missing:
        print(f'without libmodbus: {len(missing)} faults of the port over it are left out')
    if options.list:
        for fault in faults:
            print(f'{fault.name}: {fault.what}\n    breaks: {fault.promise}\n    seen by: {" ".join(fault.programs + fault.firmware)}')
        return 0
    jobs = max(1, min(options.jobs, len(faults)))
    with tempfile.TemporaryDirectory(prefix='fathom-faults.') as folder:
        try:
            with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
                roots = [os.path.join(folder, str(number)) for number in range(jobs)]
                with_firmware = any(fault.machine for fault in faults)
                copies = list(pool.map(lambda root: Copy(root, with_firmware), roots))
                there = copies[0].firmware_tests()
                without_tools = {fault.machine for fault in faults if not there.issuperset(fault.firmware)}
                for machine in sorted(without_tools):
                    left_out = [fault for fault in faults if fault.machine == machine]
                    print(f'without the tools for {machine}: {len(left_out)} faults are left out')
                faults = [fault for fault in faults if fault.machine not in without_tools]
                own = shares(faults, jobs)
                programs = [copies[0].programs[number::jobs] for number in range(jobs)]
                seen = next(filter(None, pool.map(see_without_fault, copies, programs, own)), None)
        except Broken as error:
            print(f'without a fault: {error}\n0 passed, 1 failed')
            return 1
        if seen:
            print(f'without a fault: {seen} fails\n0 passed, 1 failed')
            return 1
        missed = try_all(faults, copies, own)
    print(f'{len(faults) - missed} passed, {missed} failed')
    return 1 if missed or not faults else 0


if __name__ == '__main__':
    sys.exit(main())
