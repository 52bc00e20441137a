#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""clang-tidy (.clang-tidy says which checks) and cppcheck find nothing in the library, the ports and the
examples.

    lint.py              all but the analyzers, which take twenty times as long as the rest
    lint.py --analyze    all: clang's, which scan-build runs, and gcc's (-fanalyzer)
"""
import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor

from common import LIBMODBUS, ROOT, WARNINGS, files, main, run

PORTS = sorted(entry.name for entry in os.scandir(os.path.join(ROOT, 'port')) if entry.is_dir())
INCLUDE = ['-Iinclude', '-Iport', *(f'-Iport/{port}' for port in PORTS), '-Iexamples/start', '-Iexamples/fathom']
# They need another compiler's headers.
FOREIGN = re.compile(r'^(port|examples)/(avr|arduino)/|^tests/firmware/virt/start\.c$')


# The self-test plants faults for the analyzer too.
IS_QUICK = sys.argv[1:] == []


def tidy(root, path):
    checks = ['--checks=-clang-analyzer-*'] if IS_QUICK else []
    good, said = run(['clang-tidy-14', '--quiet', *checks, path, '--', '-std=c99', *WARNINGS, *INCLUDE, LIBMODBUS], root)
    found = sorted(set(re.findall(r'^(\S+ (?:error|warning): .*)$', said, re.M)))
    return found or ([] if good else [f'{path}: clang-tidy failed: {said}'])


def compiler(path):
    machine = path.split('/')[1]
    if machine in ('rp2040', 'mps2', 'nrf51', 'stm32f4'):
        return ['arm-none-eabi-gcc', '-mcpu=cortex-m3', '-mthumb']
    if machine == 'virt':
        return ['riscv64-unknown-elf-gcc', '-march=rv32imac_zicsr', '-mabi=ilp32', '-ffreestanding']
    return ['gcc']


def analyze(root, path):
    """By gcc's analyzer, which sees all of it where nothing is optimised away."""
    good, said = run([*compiler(path), '-std=c99', '-fanalyzer', *WARNINGS, *INCLUDE, LIBMODBUS, '-c', path, '-o',
                      os.devnull], root)
    found = sorted(set(re.findall(r'^(\S+ (?:error|warning): .*)$', said, re.M)))
    return found or ([] if good else [f'{path}: {said}'])


def check(root, only):
    paths = [path for path in files(root, 'src', 'port', 'examples', ends='.c')
             if not FOREIGN.match(path) and (not only or path in only)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda path: tidy(root, path), paths))
        if not IS_QUICK:
            results += pool.map(lambda path: analyze(root, path), paths)
    problems = sorted({problem.replace(root + os.sep, '') for result in results for problem in result})
    good, said = run(['cppcheck', '--quiet', '--std=c99', '--enable=warning,style,performance,portability',
                      '--inline-suppr', '--error-exitcode=1', '--suppress=missingIncludeSystem', *INCLUDE,
                      *(only or files(root, 'src', 'port', 'examples', ends='.c'))], root)
    return problems if good else [*problems, f'cppcheck: {said}']


LINE = 'src/engine/line.c'
FAULTS = [
    (LINE, None, 'int fathom_x(const int *p);\nint fathom_x(const int *p) { return p == NULL ? *p : 1; }\n',
     'Dereference of null pointer'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { int x; if (n > 1) x = 2; return x; }\n', 'clang-analyzer'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { int *p = NULL; if (n > 1) p = &n; return *p; }\n',
     '=analyzer-null-dereference'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { if (n = 1) return 2; return 3; }\n', 'clang-diagnostic-parentheses'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { if (n == 1) return 2; else return 3; }\n',
     'readability-else-after-return'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { switch (n) { case 1: return 2; case 2: return 2; } return 3; }\n',
     'bugprone-branch-clone'),
    (LINE, None, 'int fathomX(int n);\nint fathomX(int n) { return n; }\n', 'readability-identifier-naming'),
    (LINE, None, 'int fathom_x(int n);\nint fathom_x(int n) { int a[2] = {0, 1}; return n > 0 ? a[2] : 0; }\n',
     'cppcheck'),
]

if __name__ == '__main__':
    if sys.argv[1:] == ['--analyze']:
        sys.argv.pop()
    main(check, FAULTS)
