#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""build.py OUT: lays the Arduino library out in OUT/Fathom and compiles its sketches, and those in sketches/, for an
Uno into OUT/images/NAME.elf, with NAME.sym (avr-nm) beside it.

As the IDE does it: its flags (platform.txt of the AVR core), nothing on the include path but the core, the variant and
src/ of the libraries, every source below src/ compiled and linked, a sketch compiled as C++ behind Arduino.h."""
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
AVR = '/usr/share/arduino/hardware/arduino/avr'
CORE = AVR + '/cores/arduino'
BOARD = ['-mmcu=atmega328p', '-DF_CPU=16000000L', '-DARDUINO=10819', '-DARDUINO_AVR_UNO', '-DARDUINO_ARCH_AVR']
COMMON = ['-c', '-g', '-Os', '-w', '-ffunction-sections', '-fdata-sections', '-flto', *BOARD]
COMPILE = {
    '.c': ['avr-gcc', *COMMON, '-std=gnu11', '-fno-fat-lto-objects'],
    # DECIMAL_DIG: avr-gcc 5.4 does not define it for C++, and WString.cpp of Debian's core needs it.
    '.cpp': ['avr-g++', *COMMON, '-std=gnu++11', '-fpermissive', '-fno-exceptions', '-fno-threadsafe-statics',
             '-Wno-error=narrowing', '-DDECIMAL_DIG=__DECIMAL_DIG__'],
    '.S': ['avr-gcc', '-c', '-g', '-x', 'assembler-with-cpp', '-flto', *BOARD],
}
LINK = ['avr-gcc', '-w', '-Os', '-g', '-flto', '-fuse-linker-plugin', '-Wl,--gc-sections', '-mmcu=atmega328p']
# A sketch's own tests include a sketch of examples/ from there; a user's sketch has no such need.
INCLUDE = ['-I' + CORE, '-I' + AVR + '/variants/standard']


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f'{" ".join(command)}:\n{done.stdout}')
    return done.stdout


def sources(folder):
    return sorted(os.path.join(where, name) for where, _, names in os.walk(folder) for name in names
                  if os.path.splitext(name)[1] in COMPILE)


def compile_all(pool, paths, base, include, out):
    def one(path):
        made = os.path.join(out, os.path.relpath(path, base) + '.o')
        os.makedirs(os.path.dirname(made), exist_ok=True)
        run([*COMPILE[os.path.splitext(path)[1]], *INCLUDE, *include, path, '-o', made])
        return made
    return list(pool.map(one, paths))


def main(out):
    library = os.path.join(out, 'Fathom')
    run(['cmake', '-DTO=' + library, '-P', os.path.join(ROOT, 'port/arduino/layout.cmake')])
    images = os.path.join(out, 'images')
    os.makedirs(images, exist_ok=True)
    archive = os.path.join(out, 'core.a')
    with ThreadPoolExecutor(2) as pool:
        core = compile_all(pool, sources(CORE), CORE, [], os.path.join(out, 'core'))
        libraries = {name: os.path.join(folder, 'src') for name, folder in
                     (('fathom_arduino.h', library), ('SoftwareSerial.h', AVR + '/libraries/SoftwareSerial'))}
        objects = {name: compile_all(pool, sources(src), src, ['-I' + src], os.path.join(out, name))
                   for name, src in libraries.items()}
    if os.path.exists(archive):
        os.remove(archive)
    run(['avr-gcc-ar', 'rcs', archive, *core])

    def sketch(path):
        name = os.path.basename(path)
        elf = os.path.join(images, name)
        source = os.path.join(path, name + '.ino')
        # Those of the tests include one of the library's.
        with open(source, encoding='utf-8') as file:
            text = file.read()
        for other in re.findall(r'^#include "(\w+)/\w+\.ino"', text, re.M):
            with open(os.path.join(library, 'examples', other, other + '.ino'), encoding='utf-8') as file:
                text += file.read()
        used = [header for header in libraries if f'#include <{header}>' in text]
        run([*COMPILE['.cpp'], *INCLUDE, *['-I' + libraries[header] for header in used],
             '-I' + os.path.join(library, 'examples'), '-include', 'Arduino.h', '-x', 'c++', source, '-o', elf + '.o'])
        run([*LINK, elf + '.o', *[made for header in used for made in objects[header]], archive, '-lm',
             '-o', elf + '.elf'])
        with open(elf + '.sym', 'w', encoding='utf-8') as file:
            file.write(run(['avr-nm', elf + '.elf']))
        print(name, run(['avr-size', elf + '.elf']).split('\n')[1])

    folders = [os.path.join(library, 'examples'), os.path.join(HERE, 'sketches')]
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(sketch, [os.path.join(folder, name) for folder in folders
                               for name in sorted(os.listdir(folder))]))


if __name__ == '__main__':
    main(os.path.abspath(sys.argv[1]))
