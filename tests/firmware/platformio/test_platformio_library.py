#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""test_platformio_library.py OUT: the package that PlatformIO has made and compiled in OUT (build.py)."""
import json
import os
import re
import sys
import tarfile

import build

sys.path.insert(0, os.path.join(build.ROOT, 'tests', 'support'))
import cases

OUT = sys.argv[1]
PACKAGE = os.path.join(OUT, 'Fathom.tar.gz')


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


MANIFEST = json.loads(read(build.ROOT, 'library.json'))


def packed():
    with tarfile.open(PACKAGE) as archive:
        return [entry for entry in archive.getmembers() if not entry.isdir()]


def below(*folders):
    return {os.path.relpath(os.path.join(where, name), build.ROOT) for folder in folders
            for where, _, names in os.walk(os.path.join(build.ROOT, folder)) for name in names}


def compiled(environment):
    """The sources of Fathom that PlatformIO compiled there."""
    said = read(OUT, 'said', environment + '.txt')
    return {path for path in re.findall(r' (?:\S*/)?libdeps/\w+/Fathom/(\S+\.(?:c|cpp|S))\b', said)}


def core(without=()):
    return {path for path in below('src') if path.endswith('.c')} - {'src/codec/' + name for name in without}


def test_the_manifest_says_what_is_so_elsewhere():
    version = re.search(r'FATHOM_VERSION_STRING "(.*)"', read(build.ROOT, 'include/fathom/version.h'))[1]
    assert MANIFEST['version'] == version
    assert MANIFEST['license'] == 'MIT' and read(build.ROOT, 'LICENSE').startswith('MIT License')
    for header in MANIFEST['headers']:
        assert os.path.exists(os.path.join(build.ROOT, 'include', header)), header


def test_the_package_has_the_library_and_the_ports_that_its_page_names_and_no_more():
    names = {entry.name for entry in packed()}
    # The page of the script names its ports.
    ports = re.search(r"^PORTS = \((.*)\)", read(build.ROOT, 'port/platformio/library.py'), re.M)[1]
    wanted = {path for path in below('include', 'src', 'port/serial', *('port/' + name for name in re.findall(r'\w+', ports)))
              if path.endswith(('.c', '.h', '.hpp', '.cpp'))}
    assert wanted <= names, wanted - names
    others = {name for name in names - wanted if not name.endswith('toolchain.cmake')}
    assert others <= {'LICENSE', 'README.md', 'library.json', 'include/COST.md', 'include/README.md',
                      'port/platformio/library.py'}, others
    assert {'LICENSE', 'library.json', 'port/platformio/library.py'} <= others, others


def test_there_is_no_link_in_it():
    assert all(entry.isfile() for entry in packed())


def test_without_a_port_the_library_is_compiled_and_nothing_else():
    assert compiled('alone') == core(without=('crc16.c',)), compiled('alone') ^ core()


def test_on_an_avr_the_port_brings_its_own_crc():
    port = {path for path in below('port/avr') if path.endswith('.c')} - {'port/avr/crc16_table.c'}
    assert compiled('avr') == core(without=('crc16.c', 'crc16_small.c')) | port


def test_on_an_stm32_the_port_that_is_named_is_compiled():
    port = {path for path in below('port/stm32f4') if path.endswith('.c')}
    assert compiled('stm32f4') == core(without=('crc16.c',)) | port


def test_with_the_framework_of_arduino_its_port_needs_no_line():
    port = {path for path in below('port/arduino') if path.endswith('.cpp')}
    assert compiled('hps167s') == core(without=('crc16.c',)) | port


def test_a_sketch_that_has_the_interrupt_of_timer0_itself_links_beside_the_port():
    # PlatformIO makes an archive of the library, of which only what is named is linked.
    assert os.path.exists(os.path.join(OUT, 'images/timer0.elf'))


def test_a_port_that_is_not_there_is_refused_with_those_that_are():
    said = read(OUT, 'said', 'unknown.txt')
    assert 'custom_fathom_port = posix: it may be arduino, avr, stm32f4' in said, said
    assert said.endswith('exit status 1\n'), said


def test_it_is_found_by_its_headers_and_by_the_name_that_the_manifest_has():
    for environment in build.IMAGES:
        said = read(OUT, 'said', environment + '.txt')
        assert re.search(rf'\|-- Fathom @ {re.escape(MANIFEST["version"])} \(License: MIT', said), said


cases.run(globals())
