# SPDX-License-Identifier: MIT
"""What the tests against Modbus that others wrote share: three clients and two servers that take the same
words.

A client does steps (see steps.h): 'read:0x0100:1', 'write:0x0200:9', 'many:0x20:0,180', 'input:8:4',
'coils:0:1', 'identify' (a function that no sensor has: 0x2B, or 0x11 where that is what the client can send).
Each has an outcome in words: the values read, four hex digits each, 'done', 'exception 2', 'no response', or
what else the client says."""
import asyncio
import logging
import os
import re
import sys
import tempfile
import termios
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), 'e2e'))

from pymodbus.client import ModbusSerialClient  # noqa: E402
from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock  # noqa: E402
from pymodbus.exceptions import ModbusIOException  # noqa: E402
from pymodbus.mei_message import ReadDeviceInformationRequest  # noqa: E402
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer  # noqa: E402

import e2e  # noqa: E402

PROGRAMS = os.path.join(os.environ.get('FATHOM_BUILD') or os.path.join(e2e.ROOT, 'build'), 'tests', 'tool')
LINES = {'a16': (9600, 'none'), 'a05': (9600, 'none'),
         'hps167s': (19200, 'even')}  # the sensors' own settings
SOON = 5  # seconds for a response that comes; the slowest takes 0.52
QUIET = 0.5  # seconds; what must not be answered would take the simulator 20 ms, or 200 for two measurements

logging.getLogger('pymodbus').setLevel(logging.CRITICAL)  # what went wrong is in the outcome


def program(name):
    path = os.path.join(PROGRAMS, name)
    if not os.access(path, os.X_OK):
        raise AssertionError(f'{path} was not built. Configure with -DFATHOM_TESTS=ALL and libmodbus-dev installed.')
    return path


class Case(e2e.Case):
    def sensor(self, *line):
        """A simulated sensor on a line of its own, with that line's settings."""
        sim = self.sim(*line)
        sim.line = LINES[re.match(r'\w+', line[0])[0]]
        return sim

    def two_ends(self):
        """Of a line of its own."""
        folder = tempfile.mkdtemp(dir=self.folder)
        ends = [os.path.join(folder, name) for name in ('server', 'client')]
        self.start(['socat', *(f'pty,raw,echo=0,link={end}' for end in ends)])
        deadline = time.monotonic() + e2e.PATIENCE
        while not all(os.path.exists(end) for end in ends):
            self.assertLess(time.monotonic(), deadline, 'socat did not make its terminals')
            time.sleep(0.01)
        return ends

    def served(self, line, unit, first, values):
        """Where a client finds a server with these registers. A value '!4' is a register that breaks:
        exception 4, or another number where the server can send it."""
        server, client = self.two_ends()
        self.serve(server, line, unit, first, values)
        return client

    transport = 'posix'

    def fathom_client(self, port, line, *steps, seconds=SOON):
        """The same steps by our own client; for the tests against servers."""
        return self.tell(['fathom_client', self.transport], port, line, seconds, *steps)

    def tell(self, client, port, line, seconds, *steps):
        done = self.start([program(client[0]), *client[1:], port, *line, round(seconds * 1000), *steps]).finish()
        self.assertEqual((done.code, done.err), (0, ''), done)
        return done.out.splitlines()


class Libmodbus:
    """For a Case."""
    most_unit = 247  # that it takes

    def ask(self, sim, unit, *steps, seconds=SOON):
        steps = ['raw:0x2B,0x0E,1,0' if step == 'identify' else step for step in steps]
        return self.tell(['libmodbus_client'], sim, sim.line, seconds, f'unit:{unit}', *steps)


class Mbpoll:
    """For a Case. It is a program of one step; what it has to say is on stdout and on stderr."""
    most_unit = 247
    types = {'read': '4:hex', 'input': '3:hex', 'coils': '0', 'write': '4', 'many': '4'}
    failures = (('Illegal function', 'exception 1'), ('Illegal data address', 'exception 2'),
                ('Illegal data value', 'exception 3'), ('Slave device or server failure', 'exception 4'),
                ('Connection timed out', 'no response'))

    def ask(self, sim, unit, *steps, seconds=SOON):
        return [self.poll(sim, unit, seconds, *step.split(':')) for step in steps]

    def poll(self, sim, unit, seconds, kind, first='0', last=''):
        baud, parity = sim.line
        values = []
        if kind == 'identify':
            what = ['-u']
        elif kind in ('write', 'many'):
            what = ['-t', self.types[kind], '-r', int(first, 0)]
            values = [int(value, 0) for value in last.split(',')]
        else:
            what = ['-t', self.types[kind], '-r', int(first, 0), '-c', last]
        done = self.start(['mbpoll', '-m', 'rtu', '-a', unit, '-b', baud, '-P', parity, '-o', seconds, '-1',
                           '-0',
                           *what, sim, *values]).finish()
        for words, outcome in self.failures:
            if words in done.err:
                return outcome
        if (done.code, done.err) != (0, ''):
            return done.err
        if values:
            return 'done' if f'Written {len(values)} references.' in done.out else done.out
        return ' '.join(re.findall(r'^\[\d+\]:\s+(?:0x)?([0-9A-F]+)', done.out, re.M))


def make_other(port):
    """Gives a terminal other settings than any sensor's. A pseudo terminal drops the parity, of which the C
    library makes an error (EINVAL) if nothing else would change; and the simulator's stands at the sensor's
    rate already."""
    terminal = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        settings = termios.tcgetattr(terminal)
        settings[4] = settings[5] = termios.B1200
        termios.tcsetattr(terminal, termios.TCSANOW, settings)
    finally:
        os.close(terminal)


class Pymodbus:
    """For a Case. Closes the port when the test ends."""
    most_unit = 254

    def connect(self, sim, seconds=SOON):
        """The client of that port, which is opened once a test."""
        client = getattr(sim, 'client', None)
        if client is None:
            baud, parity = sim.line
            make_other(sim.port)
            client = sim.client = ModbusSerialClient(sim.port, baudrate=baud, parity=parity[0].upper(),
                                                     retries=0,
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
            return 'no response' if re.search('No [Rr]esponse', str(result)) else str(result)
        if result.isError():
            return f'exception {result.exception_code}'
        if kind in ('write', 'many'):
            # It compares nothing; the specification wants address and value, or address and count, back.
            said = (result.address, result.value if kind == 'write' else result.count)
            meant = (first, numbers[0] if kind == 'write' else len(numbers))
            return 'done' if said == meant else f'{said} acknowledged, not {meant}'
        values = result.bits if kind == 'coils' else result.registers
        return ' '.join(f'{value:04X}' for value in values)


def for_each_client(module, *all_cases):
    """Makes a class of each of these cases with each of the three."""
    for cases in all_cases:
        for client in (Libmodbus, Pymodbus, Mbpoll):
            name = client.__name__ + cases.__name__
            module[name] = type(name, (client, cases, Case), {'__module__': module['__name__']})


class LibmodbusServer:
    """For a Case. serve() returns the number of its port over TCP."""

    def serve(self, port, line, unit, first, values):
        return self.start([program('libmodbus_server'), port, *line, unit, first, *values]).expect(
            r'^ready ?(\d*)$')[1]


class Block(ModbusSparseDataBlock):
    """Registers of pymodbus, of which some break, which it makes exception 04."""
    broken = frozenset()

    def getValues(self, address, count=1):
        self.touch(address, count)
        return super().getValues(address, count)

    def setValues(self, address, values, use_as_default=False):
        self.touch(address, len(values))
        super().setValues(address, values, use_as_default)

    def touch(self, address, count):
        if self.broken.intersection(range(address, address + count)):
            raise RuntimeError('this register is broken')


class PymodbusServer:
    """For a Case: in this process, all in one thread. It has no parity on its side of the pseudo terminal:
    pyserial takes it for an error that such a terminal does not keep it."""
    loop = asyncio.new_event_loop()
    threading.Thread(target=loop.run_forever, daemon=True).start()

    def do(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self.loop).result(e2e.PATIENCE)

    def serve(self, port, line, unit, first, values):
        registers = {first + i: str(value) for i, value in enumerate(values)}
        block = Block({at: 0 if word == '!4' else int(word, 0) for at, word in registers.items()})
        block.broken = {at for at, word in registers.items() if word == '!4'}
        context = ModbusServerContext({unit: ModbusSlaveContext(hr=block, zero_mode=True)}, single=False)
        return self.do(self.begin(port, line[0], context))

    async def begin(self, port, baud, context):
        options = {'ignore_missing_slaves': True, 'broadcast_enable': True}
        if port == 'tcp':
            server = ModbusTcpServer(context, address=('127.0.0.1', 0), **options)
            serving = asyncio.ensure_future(server.serve_forever())
            self.addCleanup(self.loop.call_soon_threadsafe, serving.cancel)
            await server.serving  # it listens
            return server.server.sockets[0].getsockname()[1]
        server = ModbusSerialServer(context, port=port, baudrate=baud, **options)
        await server.start()
        self.assertIsNotNone(server.transport, f'{port} does not open')  # it keeps why to itself
        self.addCleanup(lambda: self.do(server.shutdown()))
        return None


class Tcp:
    """For a Case with a server, before it: the same server over TCP, at a port that the system has chosen."""
    transport = 'libmodbus'

    def served(self, line, unit, first, values):
        return f'tcp:127.0.0.1:{self.serve("tcp", line, unit, first, values)}'


main = e2e.main
