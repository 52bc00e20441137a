# SPDX-License-Identifier: MIT
"""Measures by clang-19 which lines, branches and conditions of the library and of the ports for Linux tests execute.

Only these files are instrumented (-fprofile-list), so that the tests themselves stay fast."""
import collections
import json
import os
import re
import shutil
import subprocess

COMPILER, PROFDATA, COV = 'clang-19', 'llvm-profdata-19', 'llvm-cov-19'
FOLDERS = ('include/fathom', 'src', 'port/serial', 'port/posix', 'port/gpio', 'port/libmodbus')
KINDS = ('unit', 'devices', 'port')  # of the tests that execute them
LABELS = f'^({"|".join(KINDS)})$'
MCDC = '-fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc'
# A static function is known by its source's name; with the folder, because error.c and uart.c are there twice.
COMPILE = ('<CMAKE_C_COMPILER> <DEFINES> <INCLUDES> <FLAGS> -Xclang -main-file-name -Xclang <SOURCE> '
           '-o <OBJECT> -c <SOURCE>')
UNSUPPORTED = re.compile(r'^(\S+?):(\d+):\d+: warning: (unsupported MC/DC.*|.*MC/DC.*exceed.*)$', re.M)

Part = collections.namedtuple('Part', 'what text line')  # a line, a branch or a condition that no test executed


class Broken(Exception):
    """It could not be measured."""


def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    return done.returncode, done.stdout


def read(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def build(root, folder, jobs):
    """Configures and builds; returns the tests, and what clang cannot instrument: (path, line, why)."""
    os.makedirs(folder, exist_ok=True)
    allowed = os.path.join(folder, 'instrumented.list')
    text = f'# {COMPILE}\n[clang]\ndefault:skip\n' + ''.join(f'source:{root}/*{name}/*=allow\n' for name in FOLDERS)
    # Each object depends on it, and so on how it is compiled.
    if not os.path.exists(allowed) or read(allowed) != text:
        with open(allowed, 'w', encoding='utf-8') as file:
            file.write(text)
    environment = dict(os.environ)
    if shutil.which('ccache'):
        environment.update(CMAKE_C_COMPILER_LAUNCHER='ccache')
    options = {'CMAKE_BUILD_TYPE': 'Debug', 'CMAKE_C_COMPILER': COMPILER, 'FATHOM_STRICT': 'OFF',
               'FATHOM_EXAMPLES': 'OFF', 'FATHOM_FIRMWARE': 'OFF', 'FATHOM_TESTS': 'ON',
               'CMAKE_C_COMPILE_OBJECT': COMPILE,
               'CMAKE_C_FLAGS_DEBUG': f'-O1 {MCDC} -fprofile-list={allowed}'}
    code, said = run(['cmake', '-S', root, '-B', folder, *(f'-D{name}={value}' for name, value in options.items())],
                     env=environment)
    if code != 0:
        raise Broken(f'cmake: {said}')
    # clang tells once, when it compiles, what it cannot instrument.
    for where, _, names in os.walk(folder):
        if re.search(r'/CMakeFiles/fathom(_posix|_gpio|_libmodbus)?\.dir/', where + '/'):
            for name in names:
                if name.endswith('.o'):
                    os.remove(os.path.join(where, name))
    code, said = run(['cmake', '--build', folder, '--parallel', str(jobs), '--target',
                      *(f'tests_{kind}' for kind in KINDS)])
    if code != 0:
        raise Broken(f'the tests are not built: {said[-4000:]}')
    unsupported = sorted({(os.path.relpath(path, root), int(line), why)
                          for path, line, why in UNSUPPORTED.findall(said)})
    # Only now, because ctest knows no command of a program that is not there.
    _, said = run(['ctest', '--test-dir', folder, '--show-only=json-v1', '--label-regex', LABELS])
    programs = sorted({test['command'][0] for test in json.loads(said)['tests']})
    return programs, unsupported


def run_tests(folder, jobs):
    """Runs them; returns where their profile is."""
    profiles = os.path.join(folder, 'profiles')
    shutil.rmtree(profiles, ignore_errors=True)
    os.mkdir(profiles)
    code, said = run(['ctest', '--test-dir', folder, '--parallel', str(2 * jobs), '--label-regex', LABELS,
                      '--no-tests=error', '--output-on-failure', '--timeout', '300'],
                     env=dict(os.environ, LLVM_PROFILE_FILE=os.path.join(profiles, '%m.profraw')))
    if code != 0:
        raise Broken(f'a test failed, so that nothing is measured:\n{said[-6000:]}')
    merged = os.path.join(profiles, 'all.profdata')
    raw = [os.path.join(profiles, name) for name in os.listdir(profiles) if name.endswith('.profraw')]
    code, said = run([PROFDATA, 'merge', '-sparse', *raw, '-o', merged])
    if code != 0:
        raise Broken(f'{PROFDATA}: {said}')
    return merged


def lines_of(segments):
    """{line: executed?} as llvm-cov has them, from (line, column, count, has a count, begins a region, is a gap)."""
    result, wrapped, at = {}, None, 0
    for line in range(segments[0][0], segments[-1][0] + 1) if segments else ():
        here = []
        while at < len(segments) and segments[at][0] == line:
            here.append(segments[at])
            at += 1
        begins = [segment for segment in here if segment[3] and segment[4] and not segment[5]]
        skipped = bool(here) and not here[0][3] and here[0][4]
        if not skipped and (begins or (wrapped is not None and wrapped[3])):
            count = wrapped[2] if wrapped is not None and wrapped[3] else 0
            result[line] = max([count, *(segment[2] for segment in begins)]) > 0
        if here:
            wrapped = here[-1]
    return result


class File:
    """One source: what there is to execute, and what of it no test did."""

    def __init__(self, root, data):
        self.path = os.path.relpath(data['filename'], root)
        self.source = read(data['filename']).split('\n')
        self.lines = lines_of(data['segments'])
        # What is inline in a header is there once for each source that includes it: any of them will do.
        self.branches, self.decisions = {}, {}
        for line, column, end, last, true, false, *_ in data['branches']:
            taken = self.branches.setdefault((line, column, end, last), [False, False])
            taken[0] |= true > 0
            taken[1] |= false > 0
        for line, column, end, last, *_, shown in data['mcdc_records']:
            known = self.decisions.setdefault((line, column, end, last), [False] * len(shown))
            for i, is_shown in enumerate(shown):
                known[i] |= is_shown

    def text(self, line, column, end, last):
        if line == end:
            return self.source[line - 1][column - 1:last - 1]
        lines = [self.source[line - 1][column - 1:], *self.source[line:end - 1], self.source[end - 1][:last - 1]]
        return ' '.join(part.strip() for part in lines)

    def counts(self):
        """(lines, missed, branches, missed, conditions, missed)"""
        missed = collections.Counter(part.what.split()[0] for part in self.missed())
        return (len(self.lines), missed['line'], 2 * len(self.branches), missed['branch'],
                sum(map(len, self.decisions.values())), missed['condition'])

    def missed(self):
        for line, executed in self.lines.items():
            if not executed:
                yield Part('line', self.source[line - 1].strip(), line)
        for at, taken in self.branches.items():
            for way, was_taken in zip(('true', 'false'), taken):
                # A label of a switch has only one way: to be jumped to.
                if not was_taken and not (way == 'false' and self.text(*at).startswith(('case ', 'default'))):
                    yield Part(f'branch {way}', self.text(*at), at[0])
        for at, shown in self.decisions.items():
            for number, is_shown in enumerate(shown, 1):
                if not is_shown:
                    yield Part(f'condition {number}', self.text(*at), at[0])


def measure(root, folder, jobs):
    """({path: File}, what clang cannot instrument)"""
    programs, unsupported = build(root, folder, jobs)
    return files_of(root, programs, run_tests(folder, jobs)), unsupported


def files_of(root, paths, merged):
    """Returns {path: File} by the profile of these programs."""
    objects = [word for path in paths[1:] for word in ('-object', path)]
    done = subprocess.run([COV, 'export', paths[0], *objects, '-instr-profile', merged], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, check=False)
    # Its warnings are about functions that it leaves out.
    if done.returncode != 0 or done.stderr:
        raise Broken(f'{COV}: {done.stderr.decode()}')
    result = {}
    for data in json.loads(done.stdout)['data'][0]['files']:
        if os.path.relpath(data['filename'], root).startswith(tuple(name + '/' for name in FOLDERS)):
            file = File(root, data)
            result[file.path] = file
    missing = [path for path in sources(root) if path not in result]
    if missing:
        raise Broken(f'nothing is known of {", ".join(missing)}')
    return result


def sources(root):
    """What has to be measured: each C file of those folders that has a function."""
    paths = [os.path.join(where, name) for folder in FOLDERS
             for where, _, names in sorted(os.walk(os.path.join(root, folder))) for name in sorted(names)
             if name.endswith('.c') or name == 'fathom_serial.h']
    return [os.path.relpath(path, root) for path in paths if has_function(path)]


def has_function(path):
    with open(path, encoding='utf-8') as file:
        return re.search(r'\)\s*\{', file.read()) is not None
