#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Programs of others use Fathom in each way that the README names; each is really built and run.

    package.py find_package BUILD    installed, moved elsewhere, and found by CMake
    package.py pkg_config BUILD      installed, moved elsewhere, and found by pkg-config
    package.py libmodbus BUILD       the port over libmodbus, in both ways, and without libmodbus the rest of it
    package.py subproject BUILD      by add_subdirectory, which builds the library and nothing else
    package.py version BUILD         the version comes from one place

BUILD is the build folder of the project, which has been built."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

from common import ROOT, files

CONSUMER = os.path.join(ROOT, 'tests', 'checks', 'consumer')


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
    for path in files(prefix, '.', ends=('.cmake', '.pc')):
        with open(os.path.join(prefix, path), encoding='utf-8') as file:
            for place in (first, ROOT, build):
                if place in file.read():
                    sys.exit(f'{path} names {place}')
                file.seek(0)
    return prefix


def configure(build, folder, *options, good=True):
    return run('cmake', '-S', CONSUMER, '-B', folder, '-DCMAKE_C_COMPILER=' + project(build, 'CMAKE_C_COMPILER'),
               '-DCMAKE_EXPORT_COMPILE_COMMANDS=ON', *options, good=good)


def find_package(build, work):
    version = project(build, 'CMAKE_PROJECT_VERSION')
    prefix = installed(build, work)
    folder = os.path.join(work, 'build')
    configure(build, folder, '-DCMAKE_PREFIX_PATH=' + prefix, '-DFATHOM_WANTED=' + version)
    run('cmake', '--build', folder)
    expect(run(os.path.join(folder, 'consumer')), f'{version} works\n')
    run(os.path.join(folder, 'ports'))
    expect(run(os.path.join(folder, 'pins')), '/dev/null, line 17: not a GPIO chip\n')
    said = configure(build, folder + '2', '-DCMAKE_PREFIX_PATH=' + prefix, '-DFATHOM_WANTED=99.0', good=False)
    expect('compatible with requested version "99.0"' in ' '.join(said.split()), True)


def pkg_config(build, work):
    version = project(build, 'CMAKE_PROJECT_VERSION')
    prefix = installed(build, work)
    folders = [os.path.dirname(os.path.join(prefix, path)) for path in files(prefix, '.', ends='.pc')]
    environment = dict(os.environ, PKG_CONFIG_PATH=os.pathsep.join(folders))
    expect(run('pkg-config', '--modversion', 'fathom', env=environment), version + '\n')
    flags = run('pkg-config', '--cflags', '--libs', 'fathom', env=environment).split()
    program = os.path.join(work, 'consumer')
    run(project(build, 'CMAKE_C_COMPILER'), '-std=c99', os.path.join(CONSUMER, 'main.c'), *flags, '-o', program)
    expect(run(program), f'{version} works\n')


def libmodbus(build, work):
    prefix = installed(build, work)
    works = 'over libmodbus it works\n'
    folder = os.path.join(work, 'build')
    options = ['-DCMAKE_PREFIX_PATH=' + prefix, '-DFATHOM_WANTED=' + project(build, 'CMAKE_PROJECT_VERSION')]
    configure(build, folder, *options)
    run('cmake', '--build', folder)
    expect(run(os.path.join(folder, 'over_libmodbus')), works)

    folders = [os.path.dirname(os.path.join(prefix, path)) for path in files(prefix, '.', ends='.pc')]
    environment = dict(os.environ, PKG_CONFIG_PATH=os.pathsep.join(folders))
    flags = run('pkg-config', '--cflags', '--libs', 'fathom_libmodbus', env=environment).split()
    program = os.path.join(work, 'over_libmodbus')
    run(project(build, 'CMAKE_C_COMPILER'), '-std=c99', os.path.join(CONSUMER, 'over_libmodbus.c'), *flags, '-o',
        program)
    expect(run(program), works)

    # A consumer that has no libmodbus: everything but that port.
    without = ['-DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON']
    folder = os.path.join(work, 'consumer_without')
    configure(build, folder, *options, *without)
    run('cmake', '--build', folder)
    run(os.path.join(folder, 'ports'))
    expect(os.path.exists(os.path.join(folder, 'over_libmodbus')), False)

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
    folder = os.path.join(work, 'consumer_of_without')
    configure(build, folder, '-DCMAKE_PREFIX_PATH=' + prefix, options[1])
    run('cmake', '--build', folder)
    run(os.path.join(folder, 'ports'))


def subproject(build, work):
    folder = os.path.join(work, 'build')
    for crc in ('256', '16'):
        configure(build, folder, '-DFATHOM_ROOT=' + ROOT, '-DFATHOM_CRC16=' + crc)
        run('cmake', '--build', folder)
        expect(run(os.path.join(folder, 'consumer')), f'{project(build, "CMAKE_PROJECT_VERSION")} works\n')
        with open(os.path.join(folder, 'compile_commands.json'), encoding='utf-8') as file:
            commands = json.load(file)
        names = {os.path.relpath(entry['file'], ROOT) for entry in commands}
        other = 'crc16_small.c' if crc == '256' else 'crc16.c'
        wanted = set(files(ROOT, 'src', ends='.c')) - {'src/codec/' + other} | {'tests/checks/consumer/main.c'}
        expect(sorted(names), sorted(wanted))
        imposed = [entry['command'] for entry in commands if '-W' in entry['command']]
        expect(imposed, [])
    made = [name for _, _, names in os.walk(folder) for name in names if name.endswith(('.a', '.so'))]
    expect(made, ['libfathom.a'])


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
        {'find_package': find_package, 'pkg_config': pkg_config, 'libmodbus': libmodbus, 'subproject': subproject,
         'version': version}[sys.argv[1]](os.path.abspath(sys.argv[2]), folder_of_all)
    print(sys.argv[1], 'works')
