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

from common import LIBMODBUS, ROOT, TEST_PORTS, WARNINGS, files, main, run

# The machine that only tests have.
TEST_MACHINES = tuple(os.path.dirname(port) for port in TEST_PORTS)
FOLDERS = ('src', 'port', 'examples', *TEST_MACHINES)
PORTS = sorted(entry.name for entry in os.scandir(os.path.join(ROOT, 'port')) if entry.is_dir())
INCLUDE = ['-Iinclude', '-Iport', *(f'-Iport/{port}' for port in PORTS), '-Iexamples/start', '-Iexamples/fathom',
           *(f'-I{folder}' for folder in (*TEST_MACHINES, *TEST_PORTS))]
# What needs another compiler's headers, and images of the tests.
LEFT_OUT = re.compile(r'(port|examples|examples/first)/(avr|arduino)/|tests/firmware/(virt/start\.c$|\w+/images/)')


IS_QUICK = sys.argv[1:] == []


def own_folders(path):
    """The programs below examples/first have a board each; those for all machines are checked with that of Linux."""
    board = re.match(r'examples/first/(?:(\w+)/)?', path)
    return ['-Iexamples/first', f'-Iexamples/first/{board[1] or "linux"}'] if board else []


def tidy(root, path):
    checks = ['-clang-analyzer-*'] if IS_QUICK else []
    if path.endswith(('/first.c', '/linux/three.c')):
        checks.append('-cert-err33-c')  # a complete first program prints without a cast
    good, said = run(['clang-tidy-14', '--quiet', '--checks=' + ','.join(checks), path, '--', '-std=c99', *WARNINGS,
                      *own_folders(path), *INCLUDE, LIBMODBUS],
                     root)
    found = sorted(set(re.findall(r'^(\S+ (?:error|warning): .*)$', said, re.M)))
    return found or ([] if good else [f'{path}: clang-tidy failed: {said}'])


def compiler(path):
    machine = path.split('/')[2 if path.startswith(('tests/', 'examples/first/')) else 1]
    if machine in ('rp2040', 'nrf51', 'stm32f4'):
        return ['arm-none-eabi-gcc', '-mcpu=cortex-m3', '-mthumb']
    if machine == 'virt':
        return ['riscv64-unknown-elf-gcc', '-march=rv32imac_zicsr', '-mabi=ilp32', '-ffreestanding']
    return ['gcc']


def analyze(root, path):
    """By gcc's analyzer, which sees all of it where nothing is optimised away."""
    # A complete first program defines vectors without the header that declares them.
    alone = ['-Wno-missing-declarations'] if path.endswith('/first.c') else []
    good, said = run([*compiler(path), '-std=c99', '-fanalyzer', *WARNINGS, *alone, *own_folders(path), *INCLUDE,
                      LIBMODBUS, '-c', path, '-o', os.devnull], root)
    found = sorted(set(re.findall(r'^(\S+ (?:error|warning): .*)$', said, re.M)))
    return found or ([] if good else [f'{path}: {said}'])


def check(root):
    paths = [path for path in files(root, *FOLDERS, ends='.c') if not LEFT_OUT.match(path)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda path: tidy(root, path), paths))
        if not IS_QUICK:
            results += pool.map(lambda path: analyze(root, path), paths)
    problems = sorted({problem.replace(root + os.sep, '') for result in results for problem in result})
    good, said = run(['cppcheck', '--quiet', '--std=c99', '--enable=warning,style,performance,portability',
                      '--inline-suppr', '--error-exitcode=1', '--suppress=missingIncludeSystem', *INCLUDE,
                      *(path for path in files(root, *FOLDERS, ends='.c') if '/images/' not in path)], root)
    return problems if good else [*problems, f'cppcheck: {said}']


if __name__ == '__main__':
    if sys.argv[1:] == ['--analyze']:
        sys.argv.pop()
    main(check)
