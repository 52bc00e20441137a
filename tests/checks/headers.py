#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each public header, and each header of a port, compiles alone and twice as C99 and as C++11; what they
declare has C linkage there, but for a port's internal/ headers. A header of C++ (.hpp) compiles as C++11 to C++20 without
exceptions and RTTI."""
import os
import re
import tempfile

from common import CXX_WARNINGS, LIBMODBUS, TEST_PORTS, WARNINGS, code_of, files, main, read, run

COMPILERS = [
    (['gcc', '-std=c99', *WARNINGS], '.c'),
    (['clang-14', '-std=c99', *WARNINGS], '.c'),
    (['g++', '-std=c++11', *CXX_WARNINGS], '.cpp'),
    (['clang++-14', '-std=c++11', *CXX_WARNINGS], '.cpp'),
]
HPP = [([compiler, f'-std=c++{year}', '-fno-exceptions', '-fno-rtti', *CXX_WARNINGS], '.cpp')
       for compiler in ('g++', 'clang++-14') for year in (11, 14, 17, 20)]
AVR = [(['avr-gcc', '-std=c99', '-mmcu=atmega328p', '-DF_CPU=16000000UL', *WARNINGS], '.c')]  # for avr-libc's headers


def check(root):
    problems = []
    with tempfile.TemporaryDirectory() as work:
        for path in files(root, 'include', 'port', *TEST_PORTS, ends=('.h', '.hpp')):
            if path.startswith('port/arduino/'):  # C++; firmware.test_arduino_library
                continue
            port = re.match(r'port/\w+|tests/firmware/\w+/port', path)
            folder = os.path.join(root, port[0]) if port else ''
            places = [os.path.join(root, 'include'), *([folder] if folder else []),
                      *([os.path.join(root, 'port/serial')] if path.startswith('tests/') else [])]
            include = [LIBMODBUS, *('-I' + place for place in places)]
            name = os.path.relpath(os.path.join(root, path), folder or os.path.join(root, 'include'))
            compilers = HPP if path.endswith('.hpp') else AVR if path.startswith('port/avr/internal/') else COMPILERS
            for compiler, ending in compilers:
                source = os.path.join(work, 'alone' + ending)
                with open(source, 'w', encoding='utf-8') as file:
                    file.write(f'#include "{name}"\n#include "{name}"\nextern int used;\nint used;\n')
                good, said = run([*compiler, *include, '-fsyntax-only', source], work)
                if not good:
                    problems.append(f'{path}: not alone with {compiler[0]} {compiler[1]}:\n{said}')
            text = read(root, path)
            if '/internal/' in path or path.endswith('.hpp'):
                continue
            if re.search(r'^[\w][^#{}=]*\);', code_of(text), re.M) and 'extern "C" {' not in text:
                problems.append(f'{path}: declares functions without extern "C"')
    return problems


if __name__ == '__main__':
    main(check)
