# SPDX-License-Identifier: MIT
"""What the end-to-end tests share: programs that are started, watched and ended, pseudo terminals, frames.

Nothing here waits for a while: every wait is for something that happens, with a deadline after which the test
fails. Programs are ended with the test that started them."""
import collections
import json
import os
import queue
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import termios
import threading
import time
import tty
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HERE = os.path.dirname(os.path.abspath(__file__))
FATHOM = os.path.abspath(os.environ.get('FATHOM') or os.path.join(ROOT, 'build', 'fathom'))
PATIENCE = 20  # seconds; far more than anything here takes on a busy machine

Done = collections.namedtuple('Done', 'code out err cpu elapsed')


class Program:
    """A program whose lines can be waited for as they come."""

    def __init__(self, *command, **options):
        options.setdefault('stdout', subprocess.PIPE)
        self.began = time.monotonic()
        self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, text=True, **options)
        self.command = ' '.join(str(word) for word in command)
        self.seen = {'out': [], 'err': []}
        self.lines = {'out': queue.Queue(), 'err': queue.Queue()}
        self.threads = []
        self.pidfd = os.pidfd_open(self.process.pid)
        self.done = None
        for name, stream in (('out', self.process.stdout), ('err', self.process.stderr)):
            if stream is not None:
                self.threads.append(threading.Thread(target=self._follow, args=(name, stream), daemon=True))
                self.threads[-1].start()

    def _follow(self, name, stream):
        try:
            for line in stream:
                self.seen[name].append(line)
                self.lines[name].put(line)
        except ValueError:  # closed by close_output
            pass
        self.lines[name].put(None)

    def expect(self, pattern, stream='out', seconds=PATIENCE):
        """The match in the next line that has one."""
        deadline = time.monotonic() + seconds
        while True:
            try:
                line = self.lines[stream].get(timeout=max(0, deadline - time.monotonic()))
            except queue.Empty:
                line = ''
            if not line:
                raise AssertionError(f'{self.command}: {pattern!r} did not come on std{stream}; it said\n'
                                     f'{"".join(self.seen["out"])}{"".join(self.seen["err"])}')
            match = re.search(pattern, line)
            if match:
                return match

    def send(self, number):
        signal.pidfd_send_signal(self.pidfd, number)

    def finish(self, seconds=PATIENCE):
        """Waits for its end: exit status, what it said, the seconds of CPU that it took, and all its seconds."""
        if self.done is None:
            if not select.select([self.pidfd], [], [], seconds)[0]:
                raise AssertionError(f'{self.command}: still runs after {seconds} s; it said\n'
                                     f'{"".join(self.seen["out"])}{"".join(self.seen["err"])}')
            _, status, usage = os.wait4(self.process.pid, 0)
            self.process.returncode = os.waitstatus_to_exitcode(status)
            for thread in self.threads:
                thread.join(PATIENCE)
            self.done = Done(self.process.returncode, ''.join(self.seen['out']), ''.join(self.seen['err']),
                             usage.ru_utime + usage.ru_stime, time.monotonic() - self.began)
        return self.done

    def end(self, number=signal.SIGTERM):
        if self.done is None:
            self.send(number)
        return self.finish()

    def discard(self):
        try:
            if self.done is None:
                self.send(signal.SIGKILL)
                self.finish()
        finally:
            os.close(self.pidfd)
            for stream in (self.process.stdout, self.process.stderr):
                if stream is not None:
                    stream.close()


class Device:
    """The far end of a pseudo terminal, for what no simulated sensor does."""

    def __init__(self):
        self.master, self.slave = os.openpty()  # the slave stays open: clients may come and go
        tty.setraw(self.slave)
        self.path = os.ttyname(self.slave)

    def read(self, count, seconds=PATIENCE):
        """Exactly so many bytes."""
        deadline = time.monotonic() + seconds
        got = b''
        while len(got) < count:
            if not select.select([self.master], [], [], max(0, deadline - time.monotonic()))[0]:
                raise AssertionError(f'{count} bytes were expected, {got.hex(" ")} came')
            got += os.read(self.master, count - len(got))
        return got

    def is_silent(self, seconds):
        """Nothing comes for so long."""
        return not select.select([self.master], [], [], seconds)[0]

    def write(self, data):
        os.write(self.master, bytes(data))

    def hang_up(self):
        for name in ('master', 'slave'):
            if getattr(self, name) >= 0:
                os.close(getattr(self, name))
                setattr(self, name, -1)

    def baud(self):
        """The rate that the client has set."""
        return termios.tcgetattr(self.slave)[4]


class Case(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='fathom-e2e-')
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *command, **options):
        program = Program(*command, **options)
        self.addCleanup(program.discard)
        return program

    def fathom(self, *arguments, **options):
        return self.start(FATHOM, *arguments, **options)

    def run_fathom(self, *arguments, seconds=PATIENCE, **options):
        return self.fathom(*arguments, **options).finish(seconds)

    def sim(self, device, *arguments):
        """A simulated sensor that is ready; .port is its path."""
        program = self.fathom('sim', device, *arguments)
        program.port = program.expect(r'^(/dev/pts/\d+)$')[1]
        return program

    def device(self):
        device = Device()
        self.addCleanup(device.hang_up)
        return device

    def preload(self, source):
        """The environment for a program with some function of the system replaced."""
        library = self.path(source.replace('.c', '.so'))
        subprocess.run(['cc', '-shared', '-fPIC', '-O1', '-o', library, os.path.join(HERE, source)], check=True)
        # A sanitizer wants to be first and need not be.
        options = os.environ.get('ASAN_OPTIONS', '') + ':verify_asan_link_order=0'
        return {**os.environ, 'LD_PRELOAD': library, 'ASAN_OPTIONS': options}

    def read_json(self, *arguments, code=0, **options):
        """Reads to the end and returns the objects."""
        done = self.run_fathom('read', *arguments, '--format', 'json', **options)
        self.assertEqual(done.code, code, done.err)
        return [json.loads(line) for line in done.out.splitlines()]


def crc16(data):
    """By definition: polynomial 0xA001, from 0xFFFF; low byte first."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return bytes((crc & 0xFF, crc >> 8))


def adu(*data):
    return bytes(data) + crc16(data)


def registers(unit, *values):
    """The answer to a read."""
    data = [unit, 3, 2 * len(values)]
    for value in values:
        data += divmod(value, 256)
    return adu(*data)


def frame(*values):
    """What an A16 (one value) or an A05 (four) sends by itself."""
    data = [0xFF]
    for value in values:
        data += divmod(value, 256)
    return bytes([*data, sum(data) & 0xFF])


def main():
    """Runs the test cases of the calling script and tells how many passed."""
    if not os.access(FATHOM, os.X_OK):
        sys.exit(f'{FATHOM} is not there; set FATHOM to the path of the tool')
    suite = unittest.defaultTestLoader.loadTestsFromModule(sys.modules['__main__'])
    if len(sys.argv) > 1:
        suite = unittest.defaultTestLoader.loadTestsFromNames(sys.argv[1:], sys.modules['__main__'])
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    failed = len(result.failures) + len(result.errors) + len(result.skipped)
    print(f'{result.testsRun - failed} passed, {failed} failed')
    sys.exit(1 if failed or not result.testsRun else 0)
