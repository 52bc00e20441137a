#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""build.py OUT: lays the Arduino library out in OUT/sketchbook/libraries/Fathom and has its sketches, and those in
sketches/, compiled for an Uno by Debian's arduino-builder, which finds the library there as the IDE does; into
OUT/images/NAME.elf, with NAME.sym (avr-nm) beside it. OUT/builder.txt is what the builder says."""
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
HARDWARE = '/usr/share/arduino/hardware'
AVR = HARDWARE + '/arduino/avr'
CORE = AVR + '/cores/arduino'
# For what the tests compile themselves.
BOARD = ['-mmcu=atmega328p', '-DF_CPU=16000000L', '-DARDUINO=10819', '-DARDUINO_AVR_UNO', '-DARDUINO_ARCH_AVR']
INCLUDE = ['-I' + CORE, '-I' + AVR + '/variants/standard']
# avr-gcc 5.4 does not define it for C++, and WString.cpp of Debian's core needs it.
CORE_NEEDS = '-DDECIMAL_DIG=__DECIMAL_DIG__'

FLAGS = {'hps_waits': ['-DFATHOM_ARDUINO_NO_TIMER0']}  # of the library and a sketch


def arduino_library(out):
    return os.path.join(out, 'sketchbook', 'libraries', 'Fathom')


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f'{" ".join(command)}:\n{done.stdout}')
    return done.stdout


def builder(out, sketch, folder):
    """The builder with Debian's core and tools; the second folder of hardware tells it of arduino-ctags."""
    # A sketch of the tests includes one of the library's or of the tests; a user's sketch has no such need.
    flags = [CORE_NEEDS, '-I' + os.path.join(arduino_library(out), 'examples'), '-I' + os.path.join(HERE, 'sketches'),
             *FLAGS.get(os.path.basename(folder), [])]
    preferences = {'compiler.cpp.extra_flags': ' '.join(flags)}
    preferences |= {f'runtime.tools.{tool}.path': '/usr' for tool in ('avr-gcc', 'avrdude', 'arduinoOTA')}
    return ['arduino-builder', '-compile', '-verbose', '-hardware', HARDWARE, '-hardware', '/usr/share/arduino-builder',
            '-tools', '/usr/bin', '-built-in-libraries', AVR + '/libraries',
            '-libraries', os.path.dirname(arduino_library(out)),
            '-fqbn', 'arduino:avr:uno', '-core-api-version', '10819', '-build-path', folder,
            '-build-cache', os.path.join(out, 'cache'),
            *(f'-prefs={name}={value}' for name, value in preferences.items()), sketch]


def main(out):
    run(['cmake', '-DTO=' + arduino_library(out), '-P', os.path.join(ROOT, 'port/arduino/layout.cmake')])
    images = os.path.join(out, 'images')
    for folder in (images, os.path.join(out, 'cache')):
        os.makedirs(folder, exist_ok=True)

    def sketch(path):
        name = os.path.basename(path)
        folder, elf = os.path.join(out, 'builds', name), os.path.join(images, name + '.elf')
        os.makedirs(folder, exist_ok=True)
        said = run(builder(out, os.path.join(path, name + '.ino'), folder))
        shutil.copy(os.path.join(folder, name + '.ino.elf'), elf)
        with open(os.path.join(images, name + '.sym'), 'w', encoding='utf-8') as file:
            file.write(run(['avr-nm', elf]))
        print(name, run(['avr-size', elf]).split('\n')[1])
        return f'== {name}\n{said}'

    first, *others = [os.path.join(folder, name) for folder in (os.path.join(arduino_library(out), 'examples'),
                                                                os.path.join(HERE, 'sketches'))
                      for name in sorted(os.listdir(folder))]
    said = [sketch(first)]  # which leaves the core in the cache
    with ThreadPoolExecutor(2) as pool:
        said += pool.map(sketch, others)
    with open(os.path.join(out, 'builder.txt'), 'w', encoding='utf-8') as file:
        file.writelines(said)


if __name__ == '__main__':
    main(os.path.abspath(sys.argv[1]))
