# SPDX-License-Identifier: MIT
"""A machine in QEMU: Debian's kernel, and as its first program the test, linked with the ports; the tool is there too.
What the test wants of the world outside it asks for on its console, and waits until that was done:
    ask WORD ARGUMENT...        from the guest; answered with one line, of a function `do_WORD`
    ok NAME, FAILED NAME: WHY   what came of a case
    end                         all cases were run
"""
import concurrent.futures
import glob
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

import debian

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
BUILD = os.path.abspath(os.environ.get('FATHOM_BUILD') or os.path.join(ROOT, 'build-gcc'))
FOLDER = os.path.join(BUILD, 'kernel')
MOST_S = 120  # of a run, which takes 12 s on an idle machine; a guest that hangs is killed then
LIBRARY = ('src/*.c', 'src/*/*.c', 'port/posix/*.c', 'port/gpio/*.c')
TOOL = ('examples/fathom/*.c', 'examples/fathom/*/*.c', 'examples/fathom/*/*/*.c', 'port/sim/*.c')
# The other choices of a table, of pins, of Modbus TCP and of publish, which want libraries.
LEFT_OUT = {'src/codec/crc16_small.c', 'examples/fathom/ports/tcp.c'}
PUBLISH = re.compile(r'examples/fathom/(mqtt/|commands/publish/|cli/config)')
OPTIONS = ('-DFATHOM_WITHOUT_LIBMODBUS -DFATHOM_PUBLISH_LACKS="" -std=c99 -Wall -Wextra -Werror '
           '-Iinclude -Iport -Iport/posix -Iport/gpio -Iexamples/fathom -Itests/port/kernel/guest').split()


def sources(*patterns):
    paths = (os.path.relpath(path, ROOT) for pattern in patterns
             for path in sorted(glob.glob(os.path.join(ROOT, pattern))))
    return [path for path in paths if path not in LEFT_OUT and
            not PUBLISH.match(path)]


def changed():
    """When any of them was, or how they are built."""
    paths = [os.path.abspath(__file__)]
    for folder in ('include', 'src', 'port', 'examples/fathom', 'tests/port/kernel/guest'):
        for here, _, names in os.walk(os.path.join(ROOT, folder)):
            paths += (os.path.join(here, name) for name in names)
    return max(os.stat(path).st_mtime for path in paths)


def compiled(compiler, folder, paths):
    newest = changed()

    def one(source):
        path = os.path.join(folder, source.replace('/', '_') + '.o')
        if os.path.exists(path) and os.stat(path).st_mtime > newest:
            return path
        ended(compiler, *OPTIONS, '-c', source, '-o', path + '.part')
        os.rename(path + '.part', path)
        return path

    os.makedirs(folder, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        return list(pool.map(one, paths))


def ended(*command):
    done = subprocess.run(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:  # a linker that warns of getgrgid_r, which wants the system's libraries, has done well
        raise RuntimeError(f'{" ".join(command)}: {done.stdout}')


def build(architecture, compiler, programs):
    """The static programs, by their names: `init` of the given sources of guest/, and `fathom`."""
    folder = os.path.join(FOLDER, architecture)
    own = [f'tests/port/kernel/guest/{name}.c' for name in ('guest', *programs)]
    library, tool = sources(*LIBRARY), sources(*TOOL)
    os.makedirs(folder, exist_ok=True)
    tool.append(os.path.join(folder, 'topics.c'))  # of the help
    ended('cmake', f'-DTO={tool[-1]}', '-P', 'examples/fathom/commands/topics.cmake')
    made = compiled(compiler, os.path.join(folder, 'objects'), own + library + tool)
    linked = {'init': made[:len(own) + len(library)], 'fathom': made[len(own):]}
    for name, objects in linked.items():
        ended(compiler, '-static', '-s', *objects, '-o', os.path.join(folder, name), '-lm')
    return {name: os.path.join(folder, name) for name in linked}


def ramdisk(files, folders=('dev', 'proc', 'sys')):
    """A cpio archive (Linux, Documentation/driver-api/early-userspace/buffer-format.rst) of files {name: content}."""
    out = bytearray()

    def add(number, name, mode, content=b''):
        fields = (number, mode, 0, 0, 1, 0, len(content), 0, 0, 0, 0, len(name) + 1, 0)
        out.extend(b'070701' + b''.join(b'%08X' % field for field in fields) + name.encode() + b'\0')
        out.extend(bytes(-len(out) % 4) + content)
        out.extend(bytes(-len(out) % 4))

    for number, name in enumerate(folders, 1):
        add(number, name, 0o040755)
    for number, (name, content) in enumerate(files.items(), len(folders) + 1):
        add(number, name, 0o100755, content)
    add(0, 'TRAILER!!!', 0)
    return bytes(out)


class Guest:
    """qemu: its command, without what is the same for all. A subclass has the do_... of what its guest asks for."""

    def __init__(self, architecture, compiler, programs, qemu, append):
        self.passed, self.wrong, self.log = [], [], []
        self.folder = tempfile.mkdtemp(prefix='fathom-kernel-')
        kernel, version = debian.kernel(FOLDER, architecture)
        print(f'Debian {version}, cloud-{architecture}', flush=True)
        files = {}
        for name, path in build(architecture, compiler, programs).items():
            with open(path, 'rb') as file:
                files[name] = file.read()
        with open(self.path('ramdisk'), 'wb') as file:
            file.write(ramdisk(files))
        self.command = [*qemu, '-accel', 'tcg', '-display', 'none', '-no-reboot', '-net', 'none', '-kernel', kernel,
                        '-initrd', self.path('ramdisk'), '-append', f'{append} quiet panic=-1',
                        '-chardev', 'stdio,id=console,signal=off', '-monitor', 'none',
                        '-qmp', f'unix:{self.path("qmp")},server=on,wait=off', '-msg', 'timestamp=on',
                        '-D', self.path('trace')]
        self.qmp = None
        self.process = None
        self.has_ended = False

    def path(self, name):
        return os.path.join(self.folder, name)

    def connect(self, name):
        """To a socket that QEMU has opened."""
        end = time.monotonic() + 10
        while True:
            try:
                one = socket.socket(socket.AF_UNIX)
                one.connect(self.path(name))
                return one
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.02)

    def order(self, name, **arguments):
        """Of QEMU's machine protocol."""
        if self.qmp is None:
            self.qmp = self.connect('qmp').makefile('rw', encoding='utf-8')
            self.qmp.readline()
            self.order('qmp_capabilities')
        self.qmp.write(json.dumps({'execute': name, 'arguments': arguments}) + '\n')
        self.qmp.flush()
        while True:
            answer = json.loads(self.qmp.readline())
            if 'error' in answer:
                raise RuntimeError(f'{name}: {answer["error"]}')
            if 'return' in answer:
                return answer['return']

    def trace(self):
        """What QEMU's devices have seen so far: (seconds, text)."""
        rows = []
        with open(self.path('trace'), encoding='utf-8', errors='replace') as file:
            for line in file:
                head, _, text = line.rstrip('\n').partition(':')
                if '@' in head:
                    rows.append((float(head.partition('@')[2]), text))
        return rows

    def do_break(self, chardev):
        self.order('chardev-send-break', id=chardev)
        return 'done'

    def answer(self, words):
        try:
            return str(getattr(self, f'do_{words[0]}')(*words[1:]))
        except Exception as error:  # pylint: disable=broad-except
            return f'failed: {error!r}'[:400]

    def take(self, line):
        verb, _, rest = line.partition(' ')
        if verb == 'ok':
            self.passed.append(rest)
        elif verb == 'FAILED':
            self.wrong.append(rest)
        elif verb == 'end':
            self.has_ended = True
        elif verb == 'ask':
            self.process.stdin.write(self.answer(rest.split()).encode() + b'\n')
            self.process.stdin.flush()

    def begin(self):
        """Before the guest runs; for what it needs."""

    def run(self):
        """Boots it and lets it run to its end. True: all is well."""
        began = time.monotonic()
        with subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT) as self.process:
            alarm = threading.Timer(MOST_S, self.process.kill)
            alarm.start()
            try:
                self.begin()
                for line in self.process.stdout:
                    text = line.decode(errors='replace').rstrip()
                    self.log.append(text)
                    if text.startswith(('ok ', 'FAILED ')):
                        print(text, flush=True)
                    self.take(text)
            finally:
                alarm.cancel()
                self.process.kill()
        if not self.has_ended:
            self.wrong.append(f'the guest did not come to its end in {MOST_S} s, or broke down')
        if self.wrong:
            print('the console:', *self.log, sep='\n    ')
        shutil.rmtree(self.folder)
        print(f'{time.monotonic() - began:.1f} s')
        print(f'{len(self.passed)} passed, {len(self.wrong)} failed')
        return not self.wrong and bool(self.passed)


def main(guest):
    sys.exit(0 if guest().run() else 1)
