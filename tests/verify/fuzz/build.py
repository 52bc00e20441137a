# SPDX-License-Identifier: MIT
"""Builds the targets: clang with libFuzzer, the sanitizers of addresses and of undefined behaviour."""
import concurrent.futures
import glob
import os
import re
import shutil
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
FOLDER = os.path.join(ROOT, 'build-fuzz')
JOBS = 2

SANITIZE = 'address,undefined'
COMPILER = ['clang-14', '-g', '-O1', '-fno-omit-frame-pointer', f'-fsanitize=fuzzer-no-link,{SANITIZE}',
            '-fno-sanitize-recover=all', '-std=c99', '-Wall', '-Wextra', '-Werror', '-Wno-unused-parameter',
            '-Iinclude', '-Iport', '-isystem/usr/include/modbus', '-Iexamples/fathom',
            *[f'-Iport/{name}' for name in ('posix', 'gpio', 'sim', 'libmodbus')], '-Itests/verify/fuzz',
            '-Itests/support', '-DFATHOM_PUBLISH_LACKS=""']
PUBLISH = re.compile(r'examples/fathom/(mqtt/|commands/publish/|cli/config)')


class Failed(Exception):
    """It cannot be built."""


def sources(*patterns, without=()):
    found = sorted(path for pattern in patterns for path in glob.glob(pattern, root_dir=ROOT))
    return [path for path in found if os.path.basename(path) not in without]


def core():
    return sources('src/*.c', 'src/*/*.c', without=('crc16_small.c',))


def libmodbus():
    return sources('port/libmodbus/*.c')


def topics():
    """The source that is made of the topics of the help."""
    os.makedirs(FOLDER, exist_ok=True)
    subprocess.run(['cmake', f'-DTO={FOLDER}/topics.c', '-P', 'examples/fathom/commands/topics.cmake'], cwd=ROOT, check=True)
    return [os.path.relpath(f'{FOLDER}/topics.c', ROOT)]


def commands(*without):
    return topics() + libmodbus() + sources('examples/fathom/*.c', 'examples/fathom/*/*.c', 'examples/fathom/*/*/*.c',
                                 'port/posix/*.c', 'port/gpio/*.c', 'port/sim/*.c', without=('main.c', *without))


def tool():
    """Without publish, which would look for its broker. without.c stands for it."""
    return [path for path in commands() if not PUBLISH.match(path)]


def publish():
    return commands('without.c')


def compile_one(source, to, text_at=None):
    """text_at: another file whose text stands in for the source's."""
    os.makedirs(os.path.dirname(to), exist_ok=True)
    command = [*COMPILER, '-iquote', os.path.dirname(source), '-c', text_at or source, '-o', to]
    if shutil.which('ccache'):
        command.insert(0, 'ccache')
    # What is stamped with the place of the worktree would not be found again from another one.
    environment = {**os.environ, 'CCACHE_BASEDIR': ROOT, 'CCACHE_NOHASHDIR': '1'}
    done = subprocess.run(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode:
        raise Failed(done.stdout)


def object_of(source):
    return os.path.join(FOLDER, 'objects', source[:-2] + '.o')


def link(target, objects, to):
    command = ['clang-14', f'-fsanitize=fuzzer,{SANITIZE}', *objects, *target.link, '-o', to]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        raise Failed(done.stdout)


def build(targets):
    needed = sorted({source for target in targets for source in target.all_sources()} | set(SEEDS))
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        list(pool.map(lambda source: compile_one(source, object_of(source)), needed))
        list(pool.map(lambda target: link(target, [object_of(one) for one in target.all_sources()], target.program()),
                      targets))
    frames = os.path.join(FOLDER, 'frames')
    command = ['clang-14', f'-fsanitize={SANITIZE}', *[object_of(source) for source in SEEDS], '-o', frames]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    if done.returncode:
        raise Failed(done.stdout)
    return subprocess.run([frames], stdout=subprocess.PIPE, text=True, check=True).stdout


SEEDS = ('tests/verify/fuzz/frames.c', 'tests/unit/vectors.c', 'tests/support/hex.c')
