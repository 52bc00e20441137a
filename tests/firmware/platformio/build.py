#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""build.py OUT: PlatformIO packs Fathom into OUT/Fathom.tar.gz by library.json, unpacks that into projects, each an
environment of project.ini, finds out what of it has to be compiled, and builds them: OUT/images/NAME.elf, and what it
said in OUT/said/NAME.txt. OUT/venv has PlatformIO, by requirements.txt.

Its compilers come as packages from its own registry; instead, platform/ has those of this system. The rest is its own:
manifest, package, search for dependencies, build by SCons."""
import json
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
IMAGES = {'avr': 'hps167s_rs485', 'stm32f4': 'hps167s_rs485_qemu', 'hps167s': 'hps167s', 'timer0': 'timer0',
          'alone': 'alone'}  # environment: image
SCONS = '4.40801.0'  # as PlatformIO names SCons 4.8.1
SOURCES = {
    'avr': ['examples/avr/hps167s_rs485.c'],
    'stm32f4': ['examples/stm32f4/hps167s_rs485.c', 'examples/stm32f4/board.h', 'examples/stm32f4/start.c',
                'examples/stm32f4/start.h', 'examples/stm32f4/stm32f4.ld', 'examples/start',
                'tests/firmware/stm32f4/images/board_qemu.c'],
    'hps167s': ['examples/arduino/hps167s/hps167s.ino'],
    'timer0': ['tests/firmware/platformio/timer0.cpp'],
    'alone': ['tests/firmware/platformio/alone.c'],
    'unknown': ['tests/firmware/platformio/alone.c'],  # which is refused
}


def pio(out, *arguments):
    """(exit status, what it said)"""
    settings = {'PLATFORMIO_CORE_DIR': os.path.join(out, 'core'), 'PLATFORMIO_SETTING_ENABLE_TELEMETRY': 'no'}
    done = subprocess.run([os.path.join(out, 'venv/bin/python'), os.path.join(HERE, 'pio.py'), *arguments],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          env={**os.environ, **settings})
    return done.returncode, done.stdout


def good(result):
    status, said = result
    if status != 0:
        sys.exit(said)
    return said


def pack(out, root, package):
    return pio(out, 'pkg', 'pack', '-o', package, root)


def lay_scons(out):
    """SCons of the venv, where PlatformIO looks for its package of it."""
    folder = os.path.join(out, 'core/packages/tool-scons')
    os.makedirs(folder)
    about = {'type': 'tool', 'name': 'tool-scons', 'version': SCONS}
    for name, text in (('package.json', json.dumps({**about, 'description': 'SCons'})),
                       ('.piopm', json.dumps({**about, 'spec': {'owner': 'platformio', 'name': 'tool-scons', 'id': None,
                                                                'requirements': None, 'uri': None}})),
                       ('scons.py', 'import SCons.Script\nSCons.Script.main()\n')):
        with open(os.path.join(folder, name), 'w', encoding='utf-8') as file:
            file.write(text)


def lay_project(environment, project, package):
    """With the sources of this one."""
    folder = os.path.join(project, 'src')
    os.makedirs(folder)
    for path in SOURCES[environment]:
        source = os.path.join(ROOT, path)
        (shutil.copytree(source, folder, dirs_exist_ok=True) if os.path.isdir(source) else shutil.copy(source, folder))
    with open(os.path.join(HERE, 'project.ini'), encoding='utf-8') as file:
        text = file.read().replace('@HERE@', HERE).replace('@PACKAGE@', package)
    with open(os.path.join(project, 'platformio.ini'), 'w', encoding='utf-8') as file:
        file.write(text)


def main(out):
    package = os.path.join(out, 'Fathom.tar.gz')
    for name in ('core', 'projects', 'images', 'said'):
        shutil.rmtree(os.path.join(out, name), ignore_errors=True)
    for name in ('images', 'said'):
        os.makedirs(os.path.join(out, name))
    lay_scons(out)
    good(pack(out, ROOT, package))
    for environment in SOURCES:
        project = os.path.join(out, 'projects', environment)
        lay_project(environment, project, package)
        status, said = pio(out, 'run', '-d', project, '-e', environment, '-v')
        with open(os.path.join(out, 'said', environment + '.txt'), 'w', encoding='utf-8') as file:
            file.write(f'{said}\nexit status {status}\n')
        if environment not in IMAGES:
            continue
        good((status, said))
        shutil.copy(os.path.join(project, '.pio/build', environment, 'program.elf'),
                    os.path.join(out, 'images', IMAGES[environment] + '.elf'))
    # What the bench of the AVR looks up.
    elf = os.path.join(out, 'images', IMAGES['avr'])
    with open(elf + '.sym', 'w', encoding='utf-8') as file:
        subprocess.run(['avr-nm', elf + '.elf'], stdout=file, check=True)


if __name__ == '__main__':
    main(os.path.abspath(sys.argv[1]))
