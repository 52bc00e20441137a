# SPDX-License-Identifier: MIT
"""What the end-to-end tests share: programs that are started, watched and ended, pseudo terminals, frames.

Nothing here waits for a while: every wait is for something that happens, with a deadline after which the test
fails. Programs are ended with the test that started them. Four cases of a file run at a time, because they mostly
wait; so none may hang on another.

A case asserts order, counts and least times. A time that it may take at most is PATIENCE, or at least 10 times what it
takes on an idle machine."""
import concurrent.futures
import contextlib
import csv
import functools
import io
import json
import os
import re
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import termios
import time
import tty
import unittest

import schema

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
HERE = os.path.dirname(os.path.abspath(__file__))
FATHOM = os.path.abspath(os.environ.get('FATHOM') or os.path.join(ROOT, 'build', 'fathom'))
PATIENCE = 20  # seconds; at least 10 times what any wait here takes on an idle machine
# Statuses of attempts that have failed, which have rows too.
FAILURES = ['impossible_values', 'port', 'no_response', 'damaged', 'exception', 'other_response', 'stale', 'line_busy',
            'other_master', 'other']


def is_ready(fd, seconds):
    """Something can be read within so many seconds. (select takes no number over 1023.)"""
    poller = select.poll()
    poller.register(fd, select.POLLIN)
    return bool(poller.poll(max(0, seconds) * 1000))


def read_exactly(count, fd, read, seconds=PATIENCE):
    """So many bytes by read(at most so many)."""
    deadline = time.monotonic() + seconds
    got = b''
    while len(got) < count:
        if not is_ready(fd, deadline - time.monotonic()):
            raise AssertionError(f'{count} bytes were expected, {got.hex(" ")} came')
        part = read(count - len(got))
        if not part:
            raise AssertionError(f'{count} bytes were expected, the end came after {got.hex(" ")}')
        got += part
    return got


class Done:
    """A program that has ended: what it said, the seconds of CPU that it took, and all its seconds."""

    def __init__(self, code, out, err, cpu, elapsed):
        self.code, self.out, self.err, self.cpu, self.elapsed = code, out, err, cpu, elapsed

    def __repr__(self):
        return f'exit status {self.code}, {self.elapsed:.3f} s, {self.cpu:.3f} s of CPU\n{self.out}{self.err}'

    @property
    def all_json(self):
        return [json.loads(line) for line in self.out.splitlines()]

    @property
    def json(self):
        """Without the attempts that have failed."""
        return [one for one in self.all_json if 'distance_mm' not in one or one.get('status') not in FAILURES]

    @property
    def told(self):
        """The objects between the lines of the standard error."""
        return [json.loads(line) for line in self.err.splitlines() if line.startswith('{')]

    @property
    def all_rows(self):
        """Of csv, without the header."""
        return list(csv.DictReader(io.StringIO(self.out)))

    @property
    def rows(self):
        """Without the attempts that have failed."""
        return [row for row in self.all_rows if row.get('status') not in FAILURES]

    @property
    def mm(self):
        """The distances of csv, as they stand there."""
        return [row['distance_mm'] for row in self.rows]


class Program:
    """A program whose lines can be waited for as they come; as text it is the port that it serves."""

    def __init__(self, command, **options):
        self.command = [str(word) for word in command]
        self.began = time.monotonic()
        pipes = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE}
        self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, **{**pipes, **options})
        self.pidfd = os.pidfd_open(self.process.pid)
        streams = (('out', self.process.stdout), ('err', self.process.stderr))
        self.streams = {stream.fileno(): (name, stream) for name, stream in streams if stream is not None}
        self.said = {'out': b'', 'err': b''}
        self.searched = {'out': 0, 'err': 0}  # of it
        self.poller = select.poll()
        self.poller.register(self.pidfd, select.POLLIN)
        for fd in self.streams:
            self.poller.register(fd, select.POLLIN)
        self.done = None
        self.port = ''
        self.link = None  # to the port

    def __str__(self):
        return self.port

    def _take(self, fd):
        """What has come from one of its streams, or its end."""
        name, stream = self.streams[fd]
        data = os.read(fd, 1 << 20)
        self.said[name] += data
        if not data:
            self.poller.unregister(fd)
            stream.close()
            del self.streams[fd]

    def _bury(self):
        while self.streams:
            self._take(next(iter(self.streams)))
        _, status, usage = os.wait4(self.process.pid, 0)
        os.close(self.pidfd)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        said = [self.said[name].decode() for name in ('out', 'err')]
        if FATHOM in self.command:
            schema.expect_records(''.join(said))
        self.done = Done(self.process.returncode, *said, usage.ru_utime + usage.ru_stime,
                         time.monotonic() - self.began)

    def hear(self, until, seconds=PATIENCE):
        """Takes in what it says until this is so, it has ended or the time is over: whether it is so."""
        deadline = time.monotonic() + seconds
        while not until() and self.done is None:
            events = self.poller.poll(max(0, deadline - time.monotonic()) * 1000)
            if not events:
                break
            for fd, _ in events:
                if fd != self.pidfd:
                    self._take(fd)
                elif len(events) == 1:
                    self._bury()
        return until()

    def has_ended(self, seconds=0):
        return self.hear(lambda: self.done is not None, seconds)

    def lines(self, stream='out'):
        return self.said[stream].decode().splitlines()

    def fail(self, words):
        raise AssertionError(f'{" ".join(self.command)}: {words}; it said\n' +
                             (self.said['out'] + self.said['err']).decode())

    def expect(self, pattern, stream='out', seconds=PATIENCE):
        """The match in the next line that has one."""
        found = []

        def search():
            while not found and b'\n' in self.said[stream][self.searched[stream]:]:
                begin = self.searched[stream]
                self.searched[stream] = self.said[stream].index(b'\n', begin) + 1
                line = self.said[stream][begin:self.searched[stream]].decode()
                found.extend(filter(None, [re.search(pattern, line)]))
            return found
        if not self.hear(search, seconds):
            self.fail(f'{pattern!r} did not come on std{stream}')
        return found[0]

    def send(self, number):
        signal.pidfd_send_signal(self.pidfd, number)

    def finish(self, seconds=PATIENCE):
        """Waits for its end."""
        if not self.has_ended(seconds):
            self.fail(f'still runs after {seconds} s')
        return self.done

    def _switches(self):
        """What the system says of it: its state, and how often it has been switched to and from."""
        with open(f'/proc/{self.process.pid}/status', encoding='ascii') as file:
            text = file.read()
        return re.search(r'State:\s+(\w)', text)[1], re.findall(r'ctxt_switches:\s+(\d+)', text)

    def until_asleep(self, seconds=0.05):
        """Waits until the program has slept for `seconds` without a break, so that its work is done."""
        deadline = time.monotonic() + PATIENCE
        before = None
        while (now := self._switches()) != before or now[0] != 'S':
            if time.monotonic() > deadline:
                self.fail('does not sleep')
            before = now
            time.sleep(seconds)

    def end(self, number=signal.SIGTERM):
        """The terminal of one that is gone may be another test's at once. So no link leads there any more."""
        if self.done is None:
            if number == signal.SIGKILL and self.link:  # which the others remove themselves
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(self.link)
            self.send(number)
        return self.finish()


@functools.lru_cache(None)
def start_cpu():
    """Seconds of CPU that the tool needs to start and to end, as it was built, on this machine."""
    return max(Program([FATHOM, '--version']).finish().cpu for _ in range(3))


class Device:
    """The far end of a pseudo terminal, for what no simulated sensor does; as text it is the port."""

    def __init__(self):
        self.master, self.slave = os.openpty()  # the slave stays open: clients may come and go
        tty.setraw(self.slave)
        self.port = os.ttyname(self.slave)

    def __str__(self):
        return self.port

    def read(self, count, seconds=PATIENCE):
        """Exactly so many bytes."""
        return read_exactly(count, self.master, lambda most: os.read(self.master, most), seconds)

    def is_silent(self, seconds=0):
        """Nothing comes for so long."""
        return not is_ready(self.master, seconds)

    def rest(self):
        """Reads all that an ended program wrote. The kernel passes bytes from the slave of a pseudo terminal to its
        master some time after the write has returned. A mark that is written behind them passes the same queue."""
        mark = b'the end of what was written'
        os.write(self.slave, mark)
        got = b''
        while not got.endswith(mark):
            got += self.read(1)
        return got[:-len(mark)]

    def write(self, data):
        os.write(self.master, bytes(data))

    def asked(self, request, response=b''):
        """This request comes and is answered so."""
        got = self.read(len(request))
        assert got == request, f'{got.hex(" ")} came, not {request.hex(" ")}'
        self.write(response)

    def hang_up(self):
        for name in ('master', 'slave'):
            if getattr(self, name) >= 0:
                os.close(getattr(self, name))
                setattr(self, name, -1)

    def baud(self):
        """The rate that the client has set."""
        return termios.tcgetattr(self.slave)[4]


def words_of(*line):
    """Text is split as a shell does; what is no text is words as they are."""
    return [word for part in line for word in (shlex.split(part) if isinstance(part, str) else part)]


class Case(unittest.TestCase):
    """Where it says line, it is words for the tool: one text, or several texts and lists (see words_of)."""
    maxDiff = None

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='fathom-e2e-')
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, command, **options):
        program = Program(command, **options)
        self.addCleanup(lambda: program.end(signal.SIGKILL))
        return program

    def fathom(self, *line, **options):
        return self.start([FATHOM, *words_of(*line)], **options)

    def run_fathom(self, *line, seconds=PATIENCE, **options):
        return self.fathom(*line, **options).finish(seconds)

    def sim(self, *line):
        """A simulated sensor that is ready."""
        program = self.fathom('sim', *line)
        words = program.command
        program.port = program.expect(r'^(/dev/pts/\d+)$')[1]
        program.link = words[words.index('--link') + 1] if '--link' in words else None
        return program

    def device(self):
        device = Device()
        self.addCleanup(device.hang_up)
        return device

    def beside(self, *line, **options):
        """A device that the test plays, and a tool that works at it. Where the tool writes a header, the port
        is open."""
        device = self.device()
        program = self.fathom(*line, ['--port', device.port], **options)
        if '--format csv' in ' '.join(program.command):
            program.expect('^name,')
        return device, program

    def play(self, line, request, *scripts):
        """Each request is answered by a script (bytes are written, numbers are pauses in seconds), and that
        is all: what came of it."""
        device, reader = self.beside(line, ['--count', len(scripts)])
        for script in scripts:
            device.asked(request)
            for step in script:
                if isinstance(step, bytes):
                    device.write(step)
                else:
                    reader.has_ended(step)
        return reader.finish()

    def ends(self, what, code, *said, out=None, **options):
        """A program, or one of this line, ends with this exit status, this on the standard error (text,
        patterns) and just this on the standard output."""
        program = what if isinstance(what, (Program, Done)) else self.fathom(what, **options)
        done = program.finish() if isinstance(program, Program) else program
        self.assertEqual(done.code, code, done)
        for words in said:
            if isinstance(words, re.Pattern):
                self.assertRegex(done.err, words)
            else:
                self.assertIn(words, done.err)
        if out is not None:
            self.assertEqual(done.out, out, done)
        return done

    def read_json(self, *line, code=0, **options):
        """fathom read to the end: the objects."""
        return self.ends(self.run_fathom('read --format json', *line, **options), code).json

    def needs_little(self, *programs):
        """They have ended, and needed at most 0.3 s of CPU more than ten starts of the tool. A program that spins for the
        seconds that these tests wait needs ten times as much."""
        for done in programs:
            self.assertLess(done.cpu, 0.3 + 10 * start_cpu(), done)

    def preload(self, source, **more):
        """The environment for a program with some function of the system replaced."""
        library = self.path('shim.so')
        subprocess.run(['cc', '-shared', '-fPIC', '-O1', '-o', library, os.path.join(HERE, source)],
                       check=True)
        # A sanitizer wants to be first and need not be.
        options = os.environ.get('ASAN_OPTIONS', '') + ':verify_asan_link_order=0'
        return {**os.environ, 'LD_PRELOAD': library, 'ASAN_OPTIONS': options, **more}


def each(*unnamed, **named):
    """A case of each row: test_NAME calls what stands below with the values of the row; one without a name is
    called after its number and its first value."""
    rows = {f'{number:02}_' + re.sub('[^a-z0-9]+', '_', str(row[0]).lower())[:50]: row
            for number, row in enumerate(unnamed)}

    class Rows:
        def __init__(self, function):
            self.function = function

        def __set_name__(self, owner, name):
            setattr(owner, name, self.function)
            for which, row in {**rows, **named}.items():
                assert not hasattr(owner, f'test_{which}'), which
                setattr(owner, f'test_{which}', self.case(row if isinstance(row, tuple) else (row,)))

        def case(self, row):
            return lambda test: self.function(test, *row)
    return Rows


def download(pins, folder):
    """The wheels that the file `pins` names, from PyPI into this folder. Returns why not, if pip cannot."""
    pip = os.path.join(folder + '.venv', 'bin', 'pip')
    try:
        subprocess.run([sys.executable, '-m', 'venv', '--clear', folder + '.venv'], check=True)
        subprocess.run([pip, '--quiet', '--disable-pip-version-check', 'download', '--retries', '1', '--no-deps', '--require-hashes',
                        '--only-binary', ':all:', '-d', folder, '-r', pins], check=True, stderr=subprocess.PIPE, text=True)
    except (OSError, subprocess.CalledProcessError) as why:
        return (getattr(why, 'stderr', None) or str(why)).strip().splitlines()[-1]
    return None


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
    """The response to a read."""
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


# Measurements: A16 6(4) example 1 and its response of 754 mm; HPS-167S table 17 and table 18, 2083 mm.
ASK_A16, SAYS_754 = adu(1, 3, 1, 0, 0, 1), bytes.fromhex('01 03 02 02 F2 38 A1')
ASK_HPS, SAYS_2083 = adu(1, 3, 0, 8, 0, 4), bytes.fromhex('01 03 08 08 23 DC B2 07 01 00 00 FD 41')


def cases_of(suite):
    for one in suite:
        if isinstance(one, unittest.TestSuite):
            yield from cases_of(one)
        else:
            yield one


def run(case):
    """What was wrong with it."""
    result = unittest.TestResult()
    began = time.monotonic()
    case.run(result)
    wrong = [text for _, text in (*result.failures, *result.errors, *result.skipped)]
    print(f'{case.id().partition(".")[2]}: {"FAILED" if wrong else "ok"}, {time.monotonic() - began:.1f} s',
          flush=True)
    return wrong


def follow_hang_up():
    """Under nohup(1) SIGHUP is ignored. The tool would inherit that, and a test that sends it SIGHUP would fail."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def main(at_once=4):
    """Runs the cases of the calling script, or those named by its arguments or by FATHOM_CASE, `at_once` at a time, and
    prints how many passed."""
    if not os.access(FATHOM, os.X_OK):
        sys.exit(f'{FATHOM} is not there; set FATHOM to the path of the tool')
    follow_hang_up()
    module, names = sys.modules['__main__'], sys.argv[1:]
    loader = unittest.defaultTestLoader
    suite = loader.loadTestsFromNames(names, module) if names else loader.loadTestsFromModule(module)
    cases = list(cases_of(suite))
    part = os.environ.get('FATHOM_CASE', '')
    cases = [case for case in cases if part in case.id()] or cases # the file itself may have that name
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        done = list(pool.map(run, cases))
    failed = sum(map(bool, done))
    print(*(text for wrong in done for text in wrong), sep='\n')
    print(f'{len(done) - failed} passed, {failed} failed')
    sys.exit(1 if failed or not done else 0)
