# SPDX-License-Identifier: MIT
"""A Modbus RTU server that Fathom's authors did not write (pymodbus), for test_modbus.py.

    modbus_server.py PORT BAUD UNIT REGISTER=VALUE ...

Says "ready" when the port is open. Any other register is exception 02."""
import asyncio
import sys

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
from pymodbus.server.async_io import ModbusSerialServer


async def main(port, baud, unit, *registers):
    values = {}
    for register in registers:
        address, value = register.split('=')
        values[int(address, 0)] = int(value, 0)
    unit_context = ModbusSlaveContext(hr=ModbusSparseDataBlock(values), zero_mode=True)
    server = ModbusSerialServer(ModbusServerContext({int(unit): unit_context}, single=False), port=port,
                                baudrate=int(baud), ignore_missing_slaves=True)
    await server.start()
    if server.transport is None:  # it keeps why to itself
        sys.exit(f'{port} does not open')
    print('ready', flush=True)
    await server.serve_forever()


asyncio.run(main(*sys.argv[1:]))
