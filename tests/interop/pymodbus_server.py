# SPDX-License-Identifier: MIT
"""A Modbus RTU or TCP server that Fathom's authors did not write (pymodbus).

    pymodbus_server.py PORT|tcp BAUD UNIT FIRST VALUE ...

Says "ready" when the port is open, over TCP "ready N" with a port N that the system has chosen on the loopback
interface. Registers below FIRST or past the last value are exception 02. A value "!4"
is a register that breaks, which pymodbus makes exception 04."""
import asyncio
import logging
import sys

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer


class Block(ModbusSparseDataBlock):
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


async def serve_tcp(context):
    server = ModbusTcpServer(context, address=('127.0.0.1', 0), ignore_missing_slaves=True, broadcast_enable=True)
    serving = asyncio.ensure_future(server.serve_forever())
    await server.serving  # it listens
    print('ready', server.server.sockets[0].getsockname()[1], flush=True)
    await serving


async def main(port, baud, unit, first, *words):
    registers = dict(enumerate(words, int(first, 0)))
    block = Block({at: 0 if word == '!4' else int(word, 0) for at, word in registers.items()})
    block.broken = {at for at, word in registers.items() if word == '!4'}
    unit_context = ModbusSlaveContext(hr=block, zero_mode=True)
    context = ModbusServerContext({int(unit): unit_context}, single=False)
    if port == 'tcp':
        await serve_tcp(context)
    server = ModbusSerialServer(context, port=port, baudrate=int(baud), ignore_missing_slaves=True,
                                broadcast_enable=True)
    await server.start()
    if server.transport is None:  # it keeps why to itself
        sys.exit(f'{port} does not open')
    print('ready', flush=True)
    await server.serve_forever()


logging.getLogger('pymodbus').setLevel(logging.CRITICAL)
asyncio.run(main(*sys.argv[1:]))
