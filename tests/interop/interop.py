# SPDX-License-Identifier: MIT
"""What the tests against Modbus that others wrote share: three clients and two servers that take the same words.

A client does steps (see steps.h): 'read:0x0100:1', 'write:0x0200:9', 'many:0x20:0,180', 'input:8:4', 'coils:0:1',
'identify' (a function that no sensor has: 0x2B, or 0x11 where that is what the client can send). Each has an
outcome in words: the values read, four hex digits each, 'done', 'exception 2', 'no answer', or what else the
client says."""
import logging
import os
import re
import sys
import tempfile
import termios
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), 'e2e'))

from pymodbus.client import ModbusSerialClient  # noqa: E402
from pymodbus.exceptions import ModbusIOException  # noqa: E402
from pymodbus.mei_message import ReadDeviceInformationRequest  # noqa: E402

import e2e  # noqa: E402

PROGRAMS = os.environ.get('FATHOM_INTEROP') or os.path.join(e2e.ROOT, 'build', 'tests', 'interop')
LINES = {'a16': (9600, 'none'), 'a05': (9600, 'none'), 'hps167s': (19200, 'even')}  # the sensors' own settings
SOON = 2  # seconds for an answer that comes; the slowest takes 0.52
QUIET = 0.15  # seconds; what must not be answered here would take the simulator 20 ms if it were

logging.getLogger('pymodbus').setLevel(logging.CRITICAL)  # what went wrong is in the outcome


def program(name):
    path = os.path.join(PROGRAMS, name)
    if not os.access(path, os.X_OK):
        raise AssertionError(f'{path} is not there: CMake builds it when libmodbus-dev is installed; '
                             'FATHOM_INTEROP says where')
    return path


class Case(e2e.Case):
    def sensor(self, device, *arguments):
        """A simulated sensor on a line of its own, with that line's settings."""
        sim = self.sim(device, *arguments)
        sim.line = LINES[device.split(':')[0]]
        return sim

    def ends(self):
        """Two ends of a line of its own."""
        folder = tempfile.mkdtemp(dir=self.folder)
        ends = [os.path.join(folder, name) for name in ('server', 'client')]
        self.start('socat', *(f'pty,raw,echo=0,link={end}' for end in ends))
        deadline = time.monotonic() + e2e.PATIENCE
        while not all(os.path.exists(end) for end in ends):
            self.assertLess(time.monotonic(), deadline, 'socat did not make its terminals')
            time.sleep(0.01)
        return ends

    def served(self, line, unit, first, values):
        """Where a client finds a server with these registers."""
        server, client = self.ends()
        self.serve(server, line, unit, first, values)
        return client

    client = 'fathom_client'

    def fathom_client(self, port, line, *steps, seconds=SOON):
        """The same steps by our own client; for the tests against servers."""
        return self.tell(self.client, port, line, seconds, *steps)

    def tell(self, name, port, line, seconds, *steps):
        done = self.start(program(name), port, *line, round(seconds * 1000), *steps).finish()
        self.assertEqual((done.code, done.err), (0, ''), done)
        return done.out.splitlines()


class AtRates:
    """For a client. The sensor has got another rate, at which it is asked from now on."""

    def at_rate(self, sim, baud):
        client = sim.__dict__.pop('client', None)  # what is open stands at the old one
        if client is not None:
            client.close()
        sim.line = (baud, sim.line[1])


class Libmodbus(AtRates):
    """For a Case."""
    most_unit = 247  # that it takes

    def ask(self, sim, unit, *steps, seconds=SOON):
        steps = ['raw:0x2B,0x0E,1,0' if step == 'identify' else step for step in steps]
        return self.tell('libmodbus_client', sim.port, sim.line, seconds, f'unit:{unit}', *steps)


class Mbpoll(AtRates):
    """For a Case. It is a program of one step; what it has to say is on stdout and on stderr."""
    most_unit = 247
    types = {'read': '4:hex', 'input': '3:hex', 'coils': '0', 'write': '4', 'many': '4'}
    failures = (('Illegal function', 'exception 1'), ('Illegal data address', 'exception 2'),
                ('Illegal data value', 'exception 3'), ('Slave device or server failure', 'exception 4'),
                ('Connection timed out', 'no answer'))

    def ask(self, sim, unit, *steps, seconds=SOON):
        return [self.poll(sim, unit, seconds, *step.split(':')) for step in steps]

    def poll(self, sim, unit, seconds, kind, first='0', last=''):
        baud, parity = sim.line
        line = ['-m', 'rtu', '-a', unit, '-b', baud, '-P', parity, '-o', seconds, '-1', '-0']
        if kind == 'identify':
            what, values = ['-u'], []
        else:
            writes = kind in ('write', 'many')
            what = ['-t', self.types[kind], '-r', int(first, 0), *([] if writes else ['-c', last])]
            values = [int(value, 0) for value in last.split(',')] if writes else []
        done = self.start('mbpoll', *line, *what, sim.port, *values).finish()
        for words, outcome in self.failures:
            if words in done.err:
                return outcome
        if (done.code, done.err) != (0, ''):
            return done.err
        if values:
            return 'done' if f'Written {len(values)} references.' in done.out else done.out
        return ' '.join(re.findall(r'^\[\d+\]:\s+(?:0x)?([0-9A-F]+)', done.out, re.M))


def make_other(port):
    """Gives a terminal other settings than any sensor's. A pseudo terminal drops the parity, of which the C library
    makes an error (EINVAL) if nothing else would change; and the simulator's stands at the sensor's rate already."""
    terminal = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        settings = termios.tcgetattr(terminal)
        settings[4] = settings[5] = termios.B1200
        termios.tcsetattr(terminal, termios.TCSANOW, settings)
    finally:
        os.close(terminal)


class Pymodbus(AtRates):
    """For a Case. Closes the port when the test ends."""
    most_unit = 254

    def connect(self, sim, seconds=SOON):
        """The client of that port, which is opened once a test."""
        client = getattr(sim, 'client', None)
        if client is None:
            baud, parity = sim.line
            make_other(sim.port)
            client = sim.client = ModbusSerialClient(sim.port, baudrate=baud, parity=parity[0].upper(), retries=0,
                                                     reset_socket=False, strict=False, timeout=seconds)
            self.addCleanup(client.close)
            self.assertTrue(client.connect(), 'pymodbus does not open the port')
        if client.params.timeout != seconds:
            client.params.timeout = seconds
            client.socket._timeout = seconds  # the property would set up the terminal again
        return client

    def ask(self, sim, unit, *steps, seconds=SOON):
        client = self.connect(sim, seconds)
        return [self.step(client, unit, *step.split(':')) for step in steps]

    @staticmethod
    def step(client, unit, kind, first='0', last=''):
        first = int(first, 0)
        numbers = [int(value, 0) for value in last.split(',') if value]
        if kind == 'identify':
            result = client.execute(ReadDeviceInformationRequest(1, 0, unit=unit))
        elif kind == 'write':
            result = client.write_register(first, numbers[0], slave=unit)
        elif kind == 'many':
            result = client.write_registers(first, numbers, slave=unit)
        else:
            read = {'read': client.read_holding_registers, 'input': client.read_input_registers,
                    'coils': client.read_coils}[kind]
            result = read(first, numbers[0], slave=unit)
        if isinstance(result, ModbusIOException):
            return 'no answer' if re.search('No [Rr]esponse', str(result)) else str(result)
        if result.isError():
            return f'exception {result.exception_code}'
        if kind in ('write', 'many'):
            # It compares nothing; the specification wants address and value, or address and count, back.
            said = (result.address, result.value if kind == 'write' else result.count)
            meant = (first, numbers[0] if kind == 'write' else len(numbers))
            return 'done' if said == meant else f'{said} acknowledged, not {meant}'
        values = result.bits if kind == 'coils' else result.registers
        return ' '.join(f'{value:04X}' for value in values)


class LibmodbusServer:
    """For a Case."""

    def serve(self, port, line, unit, first, values):
        server = self.start(program('libmodbus_server'), port, *line, unit, first, *values)
        return server.expect(r'^ready ?(\d*)$')[1]


class PymodbusServer:
    """For a Case. It has no parity on its side of the pseudo terminal: pyserial takes it for an error that such
    a terminal does not keep it."""

    def serve(self, port, line, unit, first, values):
        server = self.start(sys.executable, os.path.join(HERE, 'pymodbus_server.py'), port, line[0], unit, first,
                            *values)
        return server.expect(r'^ready ?(\d*)$')[1]


class Tcp:
    """For a Case with a server, before it: the same server over TCP, at a port that the system has chosen."""
    client = 'fathom_libmodbus_client'

    def served(self, line, unit, first, values):
        return f'tcp:127.0.0.1:{self.serve("tcp", line, unit, first, values)}'


main = e2e.main
