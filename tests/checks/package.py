#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Programs of others use Fathom in each way that the README names; each is really built and run.

    package.py find_package BUILD    installed, moved elsewhere, and found by CMake
    package.py pkg_config BUILD      installed, moved elsewhere, and found by pkg-config: each port by its own .pc
    package.py layouts BUILD         the same with DESTDIR, and with folders of other names
    package.py libmodbus BUILD       the port over libmodbus, in both ways, and without libmodbus the rest of it
    package.py subproject BUILD      by add_subdirectory, which builds the library and nothing else
    package.py ports BUILD           by add_subdirectory or FetchContent, with one port or another
    package.py outside BUILD         a port that stands elsewhere, on Fathom in both ways
    package.py version BUILD         the version comes from one place

BUILD is the build folder of the project, which has been built."""
import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

from common import ROOT, files, read

CONSUMER = os.path.join(ROOT, 'tests', 'checks', 'consumer')
OUTSIDE = os.path.join(ROOT, 'tests', 'checks', 'outside')
# What each program of consumer/ prints. %s: the version.
SAYS = {
    'main': '%s works\n',
    'conformance': 'not seen, 26 items\n',
    'gpio': '/dev/null, line 17: not a GPIO chip\n',
    'libmodbus': 'over libmodbus it works\n',
    'posix': '/dev/null: not a serial port\n',
    'serial': '1 byte, 55\n',
    'sim': '1234 mm\n',
}
# What a port brings besides itself, and the project without any.
BRINGS = {'gpio': {'fathom_posix'}}
# The project without what is not installed for programs.
LIBRARIES = ('-DFATHOM_TESTS=OFF', '-DFATHOM_EXAMPLES=OFF', '-DCMAKE_BUILD_TYPE=Release')

# Beside the library, with the tool.
INSTALLED = ('share/doc/fathom/LICENSE', 'share/man/man1/fathom.1.gz', 'share/man/man1/fathom-read.1.gz',
             'share/bash-completion/completions/fathom', 'share/zsh/site-functions/_fathom',
             'share/fish/vendor_completions.d/fathom.fish', 'lib/systemd/system/fathom-publish.service')


def run(*command, good=True, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          **options)
    if (done.returncode == 0) != good:
        sys.exit(f'{" ".join(command)}: exit status {done.returncode}\n{done.stdout}')
    return done.stdout


def project(build, name):
    """A value of the build's cache."""
    with open(os.path.join(build, 'CMakeCache.txt'), encoding='utf-8') as file:
        return re.search(rf'^{name}:\w+=(.*)$', file.read(), re.M)[1]


def expect(value, wanted):
    if value != wanted:
        sys.exit(f'{value!r}, expected {wanted!r}')


def installed(build, work):
    """Where Fathom is after it was installed and then moved."""
    first, prefix = os.path.join(work, 'first'), os.path.join(work, 'moved')
    run('cmake', '--install', build, '--prefix', first)
    os.rename(first, prefix)
    for path in INSTALLED if project(build, 'FATHOM_EXAMPLES') == 'ON' else ():
        expect((path, os.path.exists(os.path.join(prefix, path))), (path, True))
    names_no_place(build, prefix, first)
    return prefix


def names_no_place(build, prefix, first):
    for path in files(prefix, '.', ends=('.cmake', '.pc')):
        with open(os.path.join(prefix, path), encoding='utf-8') as file:
            for place in (first, ROOT, build):
                if place in file.read():
                    sys.exit(f'{path} names {place}')
                file.seek(0)


def configure(build, folder, *options, source=CONSUMER, good=True, **more):
    return run('cmake', '-S', source, '-B', folder, '-DCMAKE_C_COMPILER=' + project(build, 'CMAKE_C_COMPILER'),
               '-DCMAKE_EXPORT_COMPILE_COMMANDS=ON', *options, good=good, **more)


def compiled(folder):
    """{path: command} of what the build in that folder compiles."""
    with open(os.path.join(folder, 'compile_commands.json'), encoding='utf-8') as file:
        return {os.path.realpath(entry['file']): entry['command'] for entry in json.load(file)}


def says(build, name):
    return SAYS[name].replace('%s', project(build, 'CMAKE_PROJECT_VERSION'))


def expect_consumers(build, folder, ports):
    """The programs of consumer/ for these ports, and no others, built there; each works."""
    run('cmake', '--build', folder)
    expect(run(os.path.join(folder, 'consumer')), says(build, 'main'))
    made = {name[len('consumer_'):] for name in os.listdir(folder) if name.startswith('consumer_')}
    expect(sorted(made), sorted(ports))
    for name in made:
        expect(run(os.path.join(folder, 'consumer_' + name)), says(build, name))


def found_by_cmake(build, prefix, work, *options, ports=frozenset(SAYS) - {'main'}):
    folder = os.path.join(work, 'found')
    shutil.rmtree(folder, ignore_errors=True)
    wanted = '-DFATHOM_WANTED=' + project(build, 'CMAKE_PROJECT_VERSION')
    configure(build, folder, '-DCMAKE_PREFIX_PATH=' + prefix, wanted, *options)
    expect_consumers(build, folder, ports)


def found_by_pkg_config(build, prefix, work):
    """Each program with what the .pc file of its port says, and two examples."""
    found = files(prefix, '.', ends='.pc')
    expect([os.path.basename(path) for path in found],
           sorted(['fathom.pc', *(f'fathom_{name}.pc' for name in SAYS if name not in ('main', 'serial'))]))
    environment = dict(os.environ, PKG_CONFIG_PATH=os.path.dirname(os.path.join(prefix, found[0])))

    def build_with(source, *modules):
        flags = run('pkg-config', '--cflags', '--libs', *modules, env=environment).split()
        program = os.path.join(work, 'program')
        run(project(build, 'CMAKE_C_COMPILER'), '-std=c99', source, *flags, '-o', program)
        return program
    for path in found:
        module = os.path.basename(path)[:-len('.pc')]
        version_told = run('pkg-config', '--modversion', module, env=environment)
        expect(version_told, project(build, 'CMAKE_PROJECT_VERSION') + '\n')
        name = module[len('fathom_'):] or 'main'
        expect(run(build_with(os.path.join(CONSUMER, name + '.c'), module)), says(build, name))
    expect(run(build_with(os.path.join(CONSUMER, 'serial.c'), 'fathom')), says(build, 'serial'))
    build_with(os.path.join(ROOT, 'examples', 'bus.c'), 'fathom_posix', 'fathom_sim')
    build_with(os.path.join(ROOT, 'examples', 'site.c'), 'fathom_gpio')


def find_package(build, work):
    prefix = installed(build, work)
    found_by_cmake(build, prefix, work)
    for other in ('99.0', '0.3'):  # before 1.0 each minor version may differ
        said = configure(build, os.path.join(work, 'other'), '-DCMAKE_PREFIX_PATH=' + prefix,
                         '-DFATHOM_WANTED=' + other, good=False)
        expect(f'compatible with requested version "{other}"' in ' '.join(said.split()), True)


def pkg_config(build, work):
    found_by_pkg_config(build, installed(build, work), work)


def layouts(build, work):
    staged = os.path.join(work, 'staged')
    run('cmake', '--install', build, '--prefix', '/opt/fathom', env=dict(os.environ, DESTDIR=staged))
    prefix = os.path.join(staged, 'opt', 'fathom')
    names_no_place(build, prefix, staged)
    found_by_cmake(build, prefix, work)
    found_by_pkg_config(build, prefix, work)

    folder, prefix = os.path.join(work, 'build'), os.path.join(work, 'prefix')
    for libraries, headers in (('lib/a/b', 'headers'), (prefix + '/full/lib', prefix + '/full/headers'),
                               ('lib', prefix + '/full/headers'), (prefix + '/full/lib', 'headers')):
        configure(build, folder, *LIBRARIES, '-DCMAKE_INSTALL_LIBDIR=' + libraries,
                  '-DCMAKE_INSTALL_INCLUDEDIR=' + headers, '-DCMAKE_INSTALL_PREFIX=' + prefix, source=ROOT)
        run('cmake', '--build', folder)
        run('cmake', '--install', folder)
        found_by_cmake(build, prefix, work, f'-Dfathom_DIR={os.path.join(prefix, libraries)}/cmake/fathom')
        found_by_pkg_config(build, prefix, work)
        shutil.rmtree(prefix)


def libmodbus(build, work):
    prefix = installed(build, work)
    # A consumer that has no libmodbus: everything but that port.
    without = ['-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON']
    ports = set(SAYS) - {'main', 'libmodbus'}
    found_by_cmake(build, prefix, work, *without, ports=ports)

    # A build that had none says so, and so does its tool; what it installs is whole without it.
    folder = os.path.join(work, 'built_without')
    said = run('cmake', '-S', ROOT, '-B', folder, '-DCMAKE_C_COMPILER=' + project(build, 'CMAKE_C_COMPILER'),
               '-DFATHOM_TESTS=OFF', '-DCMAKE_BUILD_TYPE=Debug', *without)
    expect('The port libmodbus is not built: pkg-config' in said and 'fathom has no tcp:' in said, True)
    run('cmake', '--build', folder)
    done = subprocess.run([os.path.join(folder, 'fathom'), 'read', 'hps167s', '--port', 'tcp:127.0.0.1'],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    expect((done.returncode, done.stdout), (1, ''))
    expect('tcp:127.0.0.1: this fathom was built without libmodbus, which tcp: needs' in done.stderr, True)
    prefix = os.path.join(work, 'installed_without')
    run('cmake', '--install', folder, '--prefix', prefix)
    expect([path for path in files(prefix, '.', ends=('.h', '.a', '.pc', '.cmake')) if 'libmodbus' in path], [])
    found_by_cmake(build, prefix, work, ports=ports)


def subproject(build, work):
    folder = os.path.join(work, 'build')
    for crc in ('256', '16'):
        configure(build, folder, '-DFATHOM_ROOT=' + ROOT, '-DFATHOM_CRC16=' + crc)
        expect_consumers(build, folder, ())
        names = {os.path.relpath(path, ROOT) for path in compiled(folder)}
        other = 'crc16_small.c' if crc == '256' else 'crc16.c'
        wanted = set(files(ROOT, 'src', ends='.c')) - {'src/codec/' + other} | {'tests/checks/consumer/main.c'}
        expect(sorted(names), sorted(wanted))
        imposed = [command for command in compiled(folder).values() if '-W' in command]
        expect(imposed, [])
    made = [name for _, _, names in os.walk(folder) for name in names if name.endswith(('.a', '.so'))]
    expect(made, ['libfathom.a'])


def ports(build, work):
    every = set(SAYS) - {'main'}
    of_the_system = {'fathom_conformance_host', 'arduino-library'}
    cases = [((f'FATHOM_{name.upper()}=ON',), {name}, BRINGS.get(name, set())) for name in sorted(every)] + [
        (('FATHOM_POSIX=AUTO', 'FATHOM_GPIO=OFF'), set(), set()),
        (('FATHOM_POSIX=ON', 'FATHOM_SIM=ON'), {'posix', 'sim'}, set()),
        (('FATHOM_PORTS=ON', 'FATHOM_GPIO=OFF', 'FATHOM_SERIAL=OFF'), every - {'gpio', 'serial'}, of_the_system),
        (('FATHOM_PORTS=ON',), every, of_the_system)]
    folder = os.path.join(work, 'build')  # one for all of them, which compiles the library once

    def configure_case(settings):
        said = configure(build, folder, '-DFATHOM_ROOT=' + ROOT, '-DSETTINGS=' + ';'.join(settings))
        expect([path for path, command in compiled(folder).items() if '-W' in command], [])
        return sorted(re.findall('^-- brought (.*)$', said, re.M))
    for settings, wanted, more in cases:
        expect(configure_case(settings), sorted({'fathom'} | {'fathom_' + name for name in wanted} | more))
    ports_that_cannot_be_built(build, work)
    said = configure(build, os.path.join(work, 'fetched'), '-DFATHOM_ROOT=' + ROOT, '-DFETCH=ON',
                     '-DSETTINGS=FATHOM_SIM=ON')
    expect(re.findall('^-- brought (.*)$', said, re.M), ['fathom', 'fathom_sim'])

    # A variable of the parent holds, from the first time on.
    first = os.path.join(work, 'first')
    configure(build, first, '-DFATHOM_ROOT=' + ROOT, '-DSETTINGS=FATHOM_CRC16=16')
    expect(os.path.join(ROOT, 'src/codec/crc16_small.c') in compiled(first), True)

    for settings, wanted, more in cases:
        if len(settings) == 1:
            for name in every:
                with contextlib.suppress(FileNotFoundError):
                    os.remove(os.path.join(folder, 'consumer_' + name))
            configure_case(settings)
            expect_consumers(build, folder, wanted | {name[len('fathom_'):] for name in more - of_the_system})


def ports_that_cannot_be_built(build, work):
    """Asked for: the end, and what to do. Not asked for: the rest is built."""
    empty, old = os.path.join(work, 'empty'), os.path.join(work, 'old')
    os.makedirs(empty)
    os.makedirs(os.path.join(old, 'linux'))
    with open(os.path.join(old, 'linux', 'gpio.h'), 'w', encoding='utf-8') as file:
        file.write('#define GPIO_GET_LINEHANDLE_IOCTL 1\n')
    no_modules = dict(os.environ, PKG_CONFIG_LIBDIR=empty, PKG_CONFIG_PATH='')
    cannot = [('LIBMODBUS', [], no_modules, 'pkg-config did not find libmodbus: install it (Debian: libmodbus-dev)'),
              ('LIBMODBUS', ['-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON'], None,
               'is not there: install both (Debian: pkg-config libmodbus-dev)'),
              ('GPIO', ['-DCMAKE_C_FLAGS=-isystem ' + old], None,
               'install the headers of Linux 5.10 or later (Debian: linux-libc-dev)'),
              ('GPIO', ['-DFATHOM_POSIX=OFF'], None, 'FATHOM_POSIX is OFF, and this port needs that one: turn it on'),
              ('POSIX', ['-DCMAKE_SYSTEM_NAME=Generic'], None, 'Generic is no POSIX system')]
    for number, (name, options, environment, why) in enumerate(cannot):
        folder = os.path.join(work, f'cannot{number}')
        said = ' '.join(configure(build, folder, '-DFATHOM_ROOT=' + ROOT, f'-DSETTINGS=FATHOM_{name}=ON', *options,
                                  good=False, env=environment).split())
        expect((f'FATHOM_{name} is ON, but' in said, why in said), (True, True))
        said = configure(build, folder, '-DFATHOM_ROOT=' + ROOT, '-DSETTINGS=FATHOM_PORTS=ON', *options,
                         env=environment)
        expect((f'The port {name.lower()} is not built:' in said, 'brought fathom_' + name.lower() in said),
               (True, False))
        if name != 'POSIX':  # once it is there, the same folder will do
            said = configure(build, folder, '-DFATHOM_ROOT=' + ROOT, '-DCMAKE_C_FLAGS=', '-DFATHOM_POSIX=AUTO',
                             '-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=OFF', f'-DSETTINGS=FATHOM_{name}=ON')
            expect('brought fathom_' + name.lower() in said, True)


def plant(root, path, old, new):
    """Replaces the first `old` (None: the end) of a file, which is made if need be."""
    target = os.path.join(root, path)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    text = read(root, path) if os.path.exists(target) else ''
    with open(target, 'w', encoding='utf-8') as file:
        file.write(text + new if old is None else text.replace(old, new, 1))


def outside(build, work):
    prefix = installed(build, work)
    for number, way in enumerate(('-DCMAKE_PREFIX_PATH=' + prefix, '-DFATHOM_ROOT=' + ROOT)):
        folder = os.path.join(work, str(number))
        for warnings, wanted in (('', (True, False)), ('off', (False, False)), ('on', (True, False)),
                                 ('errors', (True, True))):
            configure(build, folder, way, '-DWARNINGS=' + warnings, source=OUTSIDE)
            command = compiled(folder)[os.path.join(OUTSIDE, 'port/loopback.c')]
            expect(('-Wconversion' in command, '-Werror' in command), wanted)
            expect('-W' in compiled(folder)[os.path.join(OUTSIDE, 'main.c')], False)
        run('cmake', '--build', folder)
        expect(run(os.path.join(folder, 'outside')), 'NO_RESPONSE\n')
        for path, old, new, words in REFUSED:
            copy = os.path.join(work, 'copy')
            shutil.copytree(OUTSIDE, copy)
            plant(copy, path, old, new)
            said = configure(build, os.path.join(work, 'refused'), way, source=copy, good=False)
            expect((words, words in ' '.join(said.split())), (words, True))
            shutil.rmtree(copy)
            shutil.rmtree(os.path.join(work, 'refused'))
    page(build, work)


def page(build, work):
    """What port/README.md has for CMake, with Fathom in a folder and installed."""
    block = re.search(r'^```cmake\n(.*?)^```', read(ROOT, 'port/README.md'), re.M | re.S)[1]
    first = ''.join(block.splitlines(keepends=True)[:2])
    expect(first.startswith('set(FATHOM_SERIAL ON)\nadd_subdirectory(fathom)'), True)
    os.makedirs(os.path.join(work, 'page'))
    os.symlink(ROOT, os.path.join(work, 'page', 'fathom'))
    for name in ('main', 'clock', 'uart', 'idle'):
        with open(os.path.join(work, 'page', name + '.c'), 'w', encoding='utf-8') as file:
            file.write(f'#include "fathom_serial.h"\nint {name}(void);\nint {name}(void) {{ return 0; }}\n')
    for text in (block, block.replace(first, 'find_package(fathom REQUIRED)\n')):
        with open(os.path.join(work, 'page', 'CMakeLists.txt'), 'w', encoding='utf-8') as file:
            file.write(f'cmake_minimum_required(VERSION {project(build, "CMAKE_CACHE_MAJOR_VERSION")}.'
                       f'{project(build, "CMAKE_CACHE_MINOR_VERSION")})\nproject(page C)\n{text}')
        folder = os.path.join(work, 'page', 'build')
        configure(build, folder, '-DCMAKE_PREFIX_PATH=' + os.path.join(work, 'moved'),
                  source=os.path.join(work, 'page'))
        run('cmake', '--build', folder)
        run(os.path.join(folder, 'firmware'))
        shutil.rmtree(folder)


# What a port that stands elsewhere may not do: where, what it has, what it has instead, what CMake says.
REFUSED = [
    ('port/loopback.c', '#include "loopback.h"', '#include "loopback.h"\n#include "fathom/fathom.h"',
     'includes fathom/fathom.h. A port is below the drivers'),
    ('port/loopback.h', '#include "fathom/hal.h"', '# include <fathom/sensor/a16_pwm.h>',
     'includes fathom/sensor/a16_pwm.h'),
    ('port/internal/more.h', None, '#include "line_internal.h"\n', 'line_internal.h, which is no public header'),
    ('port/loopback.c', '#include "loopback.h"', '#include "../fathom/src/common.h"', 'which is no public header'),
    ('CMakeLists.txt', 'fathom_add_port(loopback', 'fathom_add_port(serial', 'there is fathom::serial already'),
    ('CMakeLists.txt', 'fathom_add_port(loopback', 'fathom_add_port(Loop-back', 'a name is small letters'),
    ('CMakeLists.txt', 'SOURCES port/loopback.c', 'SOURCES', 'SOURCES has no file'),
    ('CMakeLists.txt', 'SOURCES port/loopback.c', 'SOURCES port/lop.c', 'there is no'),
    ('CMakeLists.txt', 'SOURCES port', 'FILES port', 'is not understood'),
    ('CMakeLists.txt', 'WARNINGS ${WARNINGS}', 'WARNINGS perhaps', 'it may be off, on or errors'),
]


def version(build, work):
    copy = os.path.join(work, 'copy')
    for name in ('include', 'src', 'port'):
        shutil.copytree(os.path.join(ROOT, name), os.path.join(copy, name))
    shutil.copy(os.path.join(ROOT, 'CMakeLists.txt'), copy)
    options = ['-DFATHOM_PORTS=OFF', '-DFATHOM_EXAMPLES=OFF', '-DFATHOM_TESTS=OFF', '-DFATHOM_INSTALL=OFF']
    run('cmake', '-S', copy, '-B', os.path.join(work, 'same'), *options)
    header = os.path.join(copy, 'include', 'fathom', 'version.h')
    with open(header, encoding='utf-8') as file:
        text = file.read()
    for old, new in ((r'(PATCH +)\d+', r'\g<1>77'), (r'(STRING +"\d+)', r'\g<1>7'), (r'.*MINOR.*\n', '')):
        with open(header, 'w', encoding='utf-8') as file:
            file.write(re.sub(old, new, text))
        said = run('cmake', '-S', copy, '-B', os.path.join(work, 'other'), *options, good=False)
        expect('version.h says' in said, True)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as folder_of_all:
        {'find_package': find_package, 'pkg_config': pkg_config, 'layouts': layouts, 'libmodbus': libmodbus,
         'subproject': subproject, 'ports': ports, 'outside': outside,
         'version': version}[sys.argv[1]](os.path.abspath(sys.argv[2]), folder_of_all)
    print(sys.argv[1], 'works')
