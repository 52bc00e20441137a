# SPDX-License-Identifier: MIT
"""A terminal for tests: a pseudo terminal of a fixed size with a program in it, and a model of what its
screen shows. The model knows the few sequences that the tool needs; any other one fails the test."""
import contextlib
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import termios
import time

import e2e

SEQUENCE = re.compile(rb'\x1b\[(\??)([\d;]*)([A-Za-z])')


class Screen:
    """Rows of characters, and which colours there were."""

    def __init__(self, rows, columns):
        self.is_other = False  # the alternate screen is shown
        self.has_cursor = True
        self.wraps = True
        self.colours = set()
        self.main = ''  # what was written to the main screen
        self.next_size = None
        self.resize(rows, columns)

    def resize(self, rows, columns):
        self.rows, self.columns = rows, columns
        self.clear()

    def clear(self):
        self.cells = [[' '] * self.columns for _ in range(self.rows)]
        self.row = self.column = 0

    def line(self, row):
        return ''.join(self.cells[row]).rstrip()

    def text(self):
        return '\n'.join(self.line(row) for row in range(self.rows))

    def put(self, character):
        if not self.is_other:
            self.main += character
            return
        assert character >= ' ', repr(character)
        assert self.column < self.columns, f'over the right edge of row {self.row}: {character!r}'
        self.cells[self.row][self.column] = character
        self.column += 1

    def obey(self, mark, numbers, letter):
        words = [int(word) for word in numbers.split(';') if word]
        if mark == '?':
            name = {1049: 'is_other', 25: 'has_cursor', 7: 'wraps'}[words[0]]
            setattr(self, name, {'h': True, 'l': False}[letter])
            if name == 'is_other':
                self.clear()
        elif letter == 'H':
            self.row, self.column = words[0] - 1, words[1] - 1
            assert self.row < self.rows and self.column < self.columns, 'off the screen'
        elif letter == 'K':
            self.cells[self.row][self.column:] = [' '] * (self.columns - self.column)
        elif letter == 'J':
            assert words == [2]
            self.resize(*(self.next_size or (self.rows, self.columns)))
            self.next_size = None
        else:
            assert letter == 'm', letter
            self.colours.update(words)


class Terminal:
    """environment: added to what is there; None takes a name out."""

    def __init__(self, command, rows=24, columns=80, environment=None):
        self.master, self.slave = os.openpty()
        self.set_size(rows, columns)
        self.screen = Screen(rows, columns)
        self.before = termios.tcgetattr(self.slave)
        self.bytes = b''
        self.rest = b''
        wanted = {**os.environ, 'TERM': 'xterm', 'LC_ALL': 'C.UTF-8', 'NO_COLOR': None, **(environment or {})}
        wanted = {name: value for name, value in wanted.items() if value is not None}
        self.process = subprocess.Popen(['setsid', '--ctty', *command], env=wanted,
                                        stdin=self.slave, stdout=self.slave, stderr=self.slave)
        self.pidfd = os.pidfd_open(self.process.pid)

    def set_size(self, rows, columns):
        """Tells the program too (SIGWINCH)."""
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack('HHHH', rows, columns, 0, 0))

    def take(self):
        """What has come; a sequence or character that is not whole waits for its rest."""
        data = os.read(self.master, 65536)
        self.bytes += data
        data = self.rest + data
        at = 0
        while at < len(data):
            if data[at] == 0x1B:
                found = SEQUENCE.match(data, at)
                if not found:
                    assert len(data) - at < 16, data[at:at + 16]
                    break
                self.screen.obey(*(part.decode() for part in found.groups()))
                at = found.end()
                continue
            length = 1 if data[at] < 0x80 else 2 if data[at] < 0xE0 else 3 if data[at] < 0xF0 else 4
            if at + length > len(data):
                break
            self.screen.put(data[at:at + length].decode())
            at += length
        self.rest = data[at:]

    def wait(self, condition):
        """Until condition(screen) holds; returns what it returned."""
        deadline = time.monotonic() + e2e.PATIENCE
        while not (got := condition(self.screen)):
            if not e2e.is_ready(self.master, deadline - time.monotonic()):
                raise AssertionError(f'it did not come; the screen '
                                     f'is\n{self.screen.text()}\n{self.screen.main}')
            self.take()
        return got

    def changes(self):
        """Until the screen shows something else."""
        before = self.screen.text()
        self.wait(lambda screen: screen.text() != before)

    def resize(self, rows, columns):
        """What is still on its way is for the old size; the first picture of the new one begins by clearing
        the screen."""
        self.screen.next_size = (rows, columns)
        self.set_size(rows, columns)
        self.wait(lambda screen: screen.next_size is None)

    def type(self, text):
        os.write(self.master, text)

    def send(self, number):
        signal.pidfd_send_signal(self.pidfd, number)

    def take_the_rest(self):
        """Reads all that an ended program wrote. The kernel passes bytes from the slave to the master some time
        after the write has returned, so the end of the program does not mean that its last bytes can be read. A
        mark that is written behind them passes the same queue."""
        mark = b'\x1b[31999m'
        # Ctrl-S may have stopped the output. TCOON alone starts only what TCOOFF has stopped.
        termios.tcflow(self.slave, termios.TCOOFF)
        termios.tcflow(self.slave, termios.TCOON)
        os.set_blocking(self.slave, False)
        left = mark
        deadline = time.monotonic() + e2e.PATIENCE
        while not self.bytes.endswith(mark):
            with contextlib.suppress(BlockingIOError):  # the queue is full
                left = left[os.write(self.slave, left):] if left else left
            assert e2e.is_ready(self.master, deadline - time.monotonic()), self.bytes
            self.take()
        self.bytes = self.bytes[:-len(mark)]
        self.screen.colours.discard(31999)

    def finish(self):
        """Waits for the end of the program, and reads the rest of its output."""
        poller = select.poll()
        poller.register(self.master, select.POLLIN)
        poller.register(self.pidfd, select.POLLIN)
        deadline = time.monotonic() + e2e.PATIENCE
        while True:
            ready = [fd for fd, _ in poller.poll(max(0, deadline - time.monotonic()) * 1000)]
            if ready == [self.pidfd]:
                break
            if not ready:
                raise AssertionError(f'it still runs; the screen is\n{self.screen.text()}')
            self.take()
        self.take_the_rest()
        return self.process.wait()

    def discard(self):
        if self.process.poll() is None:
            self.send(signal.SIGKILL)
            self.process.wait()
        for fd in (self.master, self.slave, self.pidfd):
            os.close(fd)
