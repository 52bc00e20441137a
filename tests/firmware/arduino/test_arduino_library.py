#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""test_arduino_library.py OUT: the Arduino library that build.py has laid out and compiled in OUT."""
import os
import re
import subprocess
import sys
import tempfile
import zipfile

import build

sys.path.insert(0, os.path.join(build.ROOT, 'tests', 'support'))
import cases

OUT = sys.argv[1]
LIBRARY = build.arduino_library(OUT)
EXAMPLES = ['a02yyuw', 'a05_auto', 'a05_dyp', 'a05_modbus', 'a05_relay', 'a16_auto', 'a16_controlled', 'a16_modbus', 'a16_pwm',
            'a16_switch', 'hc_sr04', 'hps167s']
SOURCES = ['fathom_arduino.cpp', 'fathom_arduino_driver_enable.cpp']
WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wconversion', '-Wsign-conversion', '-Wshadow',
            '-Wmissing-declarations']


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


def properties():
    lines = read(LIBRARY, 'library.properties').splitlines()
    return dict(line.split('=', 1) for line in lines)


def below(folder):
    return sorted(os.path.relpath(os.path.join(where, name), folder)
                  for where, _, names in os.walk(folder) for name in names)


def test_the_manifest_has_the_fields_that_a_registry_wants():
    said = properties()
    for key in ('name', 'version', 'author', 'maintainer', 'sentence', 'paragraph', 'category', 'url', 'architectures',
                'includes'):
        assert key in said, key
        assert said[key] or key == 'url', key  # there is no home page to name
    assert said['name'] == 'Fathom' == os.path.basename(LIBRARY)
    assert said['category'] == 'Sensors'  # one of the nine that the specification has
    assert said['architectures'] == '*'
    assert len(said['sentence']) <= 100 and not said['paragraph'].startswith(said['sentence'])


def test_the_manifest_has_the_version_of_the_header():
    version = re.search(r'FATHOM_VERSION_STRING "(.*)"', read(build.ROOT, 'include/fathom/version.h'))[1]
    assert properties()['version'] == version
    assert re.search(r'FATHOM_VERSION_STRING "(.*)"', read(LIBRARY, 'src/fathom/version.h'))[1] == version


def test_another_version_in_the_manifest_is_refused_by_the_layout():
    with tempfile.TemporaryDirectory() as copy:
        subprocess.run(['cp', '-r', *(os.path.join(build.ROOT, name) for name in
                                      ('src', 'include', 'port', 'examples', 'LICENSE')), copy], check=True)
        path = os.path.join(copy, 'port/arduino/library.properties')
        text = re.sub(r'^version=.*$', 'version=9.9.9', read(path), flags=re.M)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = subprocess.run(['cmake', '-DTO=' + os.path.join(copy, 'Fathom'), '-P',
                               os.path.join(copy, 'port/arduino/layout.cmake')],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        assert done.returncode != 0 and '9.9.9' in done.stdout, done.stdout


def test_the_header_that_the_ide_includes_stands_right_in_src():
    for name in properties()['includes'].split(','):
        assert os.path.exists(os.path.join(LIBRARY, 'src', name)), name
    # All that is on the include path: nothing there may shadow what is not ours.
    assert sorted(os.listdir(os.path.join(LIBRARY, 'src'))) == [
        'core', 'fathom', 'fathom_arduino.cpp', 'fathom_arduino.h', 'fathom_arduino_driver_enable.cpp']


def test_all_of_the_core_is_there_and_the_crc_once():
    core = {path for path in below(os.path.join(build.ROOT, 'src')) if path.endswith(('.c', '.h'))}
    assert core - set(below(os.path.join(LIBRARY, 'src/core'))) == {'codec/crc16.c'}
    assert set(below(os.path.join(LIBRARY, 'src/fathom'))) == \
        {path for path in below(os.path.join(build.ROOT, 'include/fathom')) if path.endswith(('.h', '.hpp'))}


def test_the_examples_are_there_each_in_a_folder_of_its_name():
    names = sorted(os.listdir(os.path.join(LIBRARY, 'examples')))
    assert names == EXAMPLES
    for name in names:
        assert below(os.path.join(LIBRARY, 'examples', name)) == [name + '.ino'], name


def test_each_example_is_a_first_sketch_of_at_most_25_lines():
    for name in EXAMPLES:
        lines = read(LIBRARY, 'examples', name, name + '.ino').splitlines()
        assert lines[0] == '// SPDX-License-Identifier: MIT', name
        assert len(lines) - 1 <= 25, f'{name}: {len(lines) - 1} lines'


def test_the_interrupt_of_timer0_is_linked_with_a_driver_enable_pin_and_else_not():
    for name in EXAMPLES:
        symbols = read(OUT, 'images', name + '.sym')
        is_ours = re.search(r' T __vector_14$', symbols, re.M) is not None
        has_pin = '(Serial, 2)' in read(LIBRARY, 'examples', name, name + '.ino')
        assert is_ours == has_pin, name


def test_there_is_no_link_in_it_which_a_registry_refuses():
    for path in below(LIBRARY):
        assert not os.path.islink(os.path.join(LIBRARY, path)), path


def test_the_zip_has_the_same_files_below_one_folder():
    with zipfile.ZipFile(LIBRARY + '.zip') as archive:
        names = sorted(name for name in archive.namelist() if not name.endswith('/'))
    assert names == ['Fathom/' + path for path in below(LIBRARY)]


def test_the_top_of_the_repository_is_not_taken_for_a_library():
    # Its src/ alone does not compile, so no tool may find a manifest there.
    assert not os.path.exists(os.path.join(build.ROOT, 'library.properties'))


def test_the_builder_finds_the_library_by_its_header_for_each_sketch():
    """And so does a user's sketch: nothing but the folder with the library is given to it."""
    for said in read(OUT, 'builder.txt').split('== ')[1:]:
        name = said.split('\n', 1)[0]
        used = re.findall(r'^Using library (\S+) at version (\S+) in folder: (\S+)', said, re.M)
        assert ('Fathom', properties()['version'], LIBRARY) in used, name
        # What it thinks of a manifest that it does not like.
        assert not re.search(r'^(WARNING|Invalid)', said, re.M | re.I), name


def test_the_port_compiles_without_a_warning():
    # The core's headers have some, and as system headers avr-gcc takes them for C.
    for name in SOURCES:
        for options in ([], ['-DFATHOM_ARDUINO_NO_TIMER0']):
            command = ['avr-g++', '-std=c++11', '-Os', *WARNINGS, *build.BOARD, build.CORE_NEEDS, *options,
                       *build.INCLUDE, '-I' + os.path.join(LIBRARY, 'src'), '-c', os.path.join(LIBRARY, 'src', name),
                       '-o', '/dev/null']
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            assert done.returncode == 0, done.stdout
            found = [line for line in done.stdout.splitlines()
                     if re.search(r': (warning|error):', line) and not line.startswith(build.AVR)]
            assert not found, '\n'.join(found)


def on_serial1(sketch):
    """The sketch as its comment says for a board with Serial1."""
    return re.sub(r'^SoftwareSerial .*\n|^#include <SoftwareSerial.h>\n', '', sketch, flags=re.M) \
        .replace('FathomBus bus(Serial, 2)', 'FathomBus bus(Serial1, 2)').replace('console.', 'Serial.') \
        .replace('FathomStreamBus bus(sensorPort)', 'FathomBus bus(Serial1)')


def test_the_port_and_the_sketches_compile_for_a_mega_and_a_leonardo():
    with tempfile.TemporaryDirectory() as work:
        sources = [os.path.join(LIBRARY, 'src', name) for name in SOURCES]
        for name, text in [('twice', '#include <fathom_arduino.h>\n#include <fathom_arduino.h>\n'),
                           *((name, '#include <Arduino.h>\n' + on_serial1(read(LIBRARY, 'examples', name, name + '.ino')))
                             for name in EXAMPLES)]:
            sources.append(os.path.join(work, name + '.cpp'))
            with open(sources[-1], 'w', encoding='utf-8') as file:
                file.write(text)
        for chip, board, variant in (('atmega2560', 'MEGA2560', 'mega'), ('atmega32u4', 'LEONARDO', 'leonardo')):
            usb = ['-DUSB_VID=0x2341', '-DUSB_PID=0x8036'] if variant == 'leonardo' else []
            for path in sources:
                build.run(['avr-g++', '-c', '-Os', '-w', '-std=gnu++11', '-fpermissive', '-fno-exceptions', '-mmcu=' + chip,
                           '-DF_CPU=16000000L', '-DARDUINO=10819', '-DARDUINO_AVR_' + board, '-DARDUINO_ARCH_AVR',
                           *usb, build.CORE_NEEDS, '-I' + build.CORE,
                           '-I' + build.AVR + '/variants/' + variant, '-I' + os.path.join(LIBRARY, 'src'),
                           path, '-o', '/dev/null'])


CLASSES = ['HPS167S', 'HPS167S_AUTO', 'A16_AUTO', 'A16_CONTROLLED', 'A16_PWM', 'A16_MODBUS', 'A16_SWITCH', 'A05_AUTO',
           'A05_DYP', 'A05_MODBUS', 'A05_RELAY']
CONTACTS = ['A16_SWITCH', 'A05_RELAY']


def compiles(call, name):
    """Whether a class has a function, by a compiler that gets nothing else wrong in the same lines."""
    kind = 'Fathom' + ''.join(part.capitalize() for part in name.split('_'))
    text = f'#include <fathom_arduino.h>\nlong ask(const {kind} &sensor) {{ return sensor.{call}(); }}\n'
    done = subprocess.run(['avr-g++', '-fsyntax-only', '-w', '-std=gnu++11', '-x', 'c++', *build.BOARD,
                           build.CORE_NEEDS, *build.INCLUDE, '-I' + os.path.join(LIBRARY, 'src'), '-'],
                          input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0 or f"has no member named '{call}'" in done.stdout.replace('‘', "'").replace('’', "'"), \
        done.stdout
    return done.returncode == 0


def test_each_class_tells_error_and_age_and_only_a_contact_is_near_or_far():
    for name in CLASSES:
        for call in ('isError', 'ageMs'):
            assert compiles(call, name), (name, call)
        for call in ('isNear', 'isFar'):
            assert compiles(call, name) == (name in CONTACTS), (name, call)


def test_no_sketch_links_the_table_of_256_entries_or_floating_point():
    images = os.path.join(OUT, 'images')
    for name in EXAMPLES:
        text = read(images, name + '.sym')
        assert 'pulseIn' not in text and '__addsf3' not in text, name
        size = build.run(['avr-size', os.path.join(images, name + '.elf')]).split('\n')[1].split()
        ram = int(size[1]) + int(size[2])
        print(f'figure arduino_{name}_flash {int(size[0]) + int(size[1])} B')
        print(f'figure arduino_{name}_ram {ram} B')
        assert ram < 1024, name  # half of the chip's


cases.run(globals())
