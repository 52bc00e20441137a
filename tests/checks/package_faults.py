# SPDX-License-Identifier: MIT
"""What package.py --self-test plants: faults in the project's files for CMake, each found by one way to use it."""
import os
import shutil
import subprocess
import sys

from common import ROOT, plant

TOP, PORTS, INSTALL = 'CMakeLists.txt', 'port/CMakeLists.txt', 'port/install/CMakeLists.txt'
ADD = 'port/fathom_add_port.cmake'
# The way that has to fail, the file with the fault, what it has, what it has instead; and the words of the failure.
FAULTS = [
    ('find_package', INSTALL, '        INCLUDES DESTINATION ${include})', '        )',
     'fathom/codec/crc16.h: No such file'),
    ('find_package', INSTALL, 'COMPATIBILITY SameMinorVersion', 'COMPATIBILITY AnyNewerVersion',
     'FATHOM_WANTED=0.3: exit status 0'),
    ('pkg_config', INSTALL, 'set(requires fathom ${links})', 'set(requires fathom)',
     'undefined reference to `fathom_posix'),
    ('pkg_config', INSTALL, 'list(APPEND requires ${modules})', '', 'modbus.h: No such file'),
    ('pkg_config', INSTALL, '"\\${pcfiledir}/${up}"', '${CMAKE_INSTALL_PREFIX}', 'fathom/codec/crc16.h: No such file'),
    ('layouts', INSTALL, 'if(IS_ABSOLUTE ${CMAKE_INSTALL_${folder}})', 'if(OFF)',
     'fathom/codec/crc16.h: No such file'),
    ('layouts', 'port/install/fathom_port.pc.in', '@FATHOM_PC_INCLUDEDIR@', '${prefix}/include',
     'fathom_conformance.h: No such file'),
    ('subproject', TOP, 'if(FATHOM_STRICT)', 'if(TRUE)', "wait.c'], expected []"),
    ('ports', TOP, 'project(fathom', 'cmake_policy(SET CMP0126 OLD)\nproject(fathom',
     "['fathom'], expected ['fathom', 'fathom_conformance']"),
    ('ports', TOP, '    ${FATHOM_TOP_LEVEL})\noption(FATHOM_EX', '    ON)\noption(FATHOM_EX',
     "'fathom_sim'], expected ['fathom', 'fathom_conformance']"),
    ('ports', PORTS, 'message(FATAL_ERROR "FATHOM_${upper}', 'message(STATUS "FATHOM_${upper}',
     'FATHOM_LIBMODBUS=ON: exit status 0'),
    ('ports', PORTS, 'unset(FATHOM_HAS_GPIO CACHE)', '', '-DCMAKE_C_FLAGS= -DFATHOM_POSIX=AUTO'),
    ('ports', PORTS, 'if(FATHOM_MACHINE OR NOT FATHOM_PORTS)', 'if(FATHOM_MACHINE)',
     "['arduino-library', 'fathom', 'fathom_conformance'], expected"),
    ('ports', PORTS, 'set(warnings off)', 'set(warnings on)', "settings.c'], expected []"),
    ('ports', PORTS, ' LINK fathom::posix)', ')', 'undefined reference to `fathom_posix'),
    ('outside', 'port/install/fathom-config.cmake', 'include("${CMAKE_CURRENT_LIST_DIR}/fathom_add_port.cmake")', '',
     'Unknown CMake command "fathom_add_port"'),
    ('outside', PORTS, '$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/serial>', '', 'fathom_serial.h: No such file'),
    ('outside', ADD, '    fathom_check_port_layer(${name} ${paths})', '', 'exit status 0'),
    ('outside', ADD, 'fathom_warn(${target} -Werror)', 'fathom_warn(${target})',
     '(True, False), expected (True, True)'),
    ('version', TOP, 'message(FATAL_ERROR "include/', 'message(STATUS "include/', 'exit status 0'),
]
COPIED = ('CMakeLists.txt', 'LICENSE', 'include', 'src', 'port', 'examples', os.path.join('tests', 'checks'))


def self_test(work, options):
    copy, build = os.path.join(work, 'copy'), os.path.join(work, 'build')
    for name in COPIED:
        source, target = os.path.join(ROOT, name), os.path.join(copy, name)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        (shutil.copytree if os.path.isdir(source) else shutil.copy)(source, target)
    script = os.path.join(copy, 'tests', 'checks', 'package.py')

    def said(way):
        """What it says when it fails."""
        for step in (['cmake', '-S', copy, '-B', build, *options], ['cmake', '--build', build],
                     [sys.executable, script, way, build]):
            done = subprocess.run(step, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if done.returncode != 0:
                return ' '.join(done.stdout.split())
        return ''
    missed = 0
    for way, path, old, new, words in FAULTS:
        with open(os.path.join(copy, path), encoding='utf-8') as file:
            text = file.read()
        plant(copy, path, old, new)
        found = said(way)
        if words not in found:
            print(f'not found: {new!r} in {path}, by {way} ({words}); it says: {found[-400:]}')
            missed += 1
        with open(os.path.join(copy, path), 'w', encoding='utf-8') as file:
            file.write(text)
    print(f'{len(FAULTS)} planted faults, {len(FAULTS) - missed} found')
    return 1 if missed else 0
