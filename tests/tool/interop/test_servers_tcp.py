#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read, get and set against the Modbus TCP server of pyModbusTCP. servers_tcp.txt pins it; pip brings it from PyPI
into the build folder, once. Exit status 77: pip cannot."""
import glob
import os
import sys

import interop
import mqtt
import test_servers_read
from interop import e2e

WHEELS = os.path.join(interop.PROGRAMS, 'servers_tcp')


def bring():
    """Python imports the package from its wheel. Returns why not, if pip cannot."""
    why = None
    if not glob.glob(os.path.join(WHEELS, '*.whl')):
        why = e2e.download(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'servers_tcp.txt'), WHEELS)
    sys.path[:0] = glob.glob(os.path.join(WHEELS, '*.whl'))
    return why


class PyModbusTcp:
    """For a Case. It serves every unit."""

    def serve(self, port, line, unit, first, values):
        from pyModbusTCP.server import DataBank, ModbusServer  # pylint: disable=import-outside-toplevel
        bank = DataBank(h_regs_size=0x300)
        bank.set_holding_registers(first, [int(str(value), 0) for value in values])
        number = mqtt.free_port()
        server = ModbusServer('127.0.0.1', number, no_block=True, data_bank=bank)
        server.start()
        self.addCleanup(server.stop)
        return number


class Read(interop.Tcp, PyModbusTcp, interop.Case):
    @e2e.each(hps167s=('hps167s', 8, test_servers_read.DATASHEET, '2083'), a16=('a16:1:modbus', 0x0100, ['754'], '754'))
    def reads(self, sensor, first, values, mm):
        done = self.ends(f'read {sensor} --port {self.served(None, 1, first, values)} --count 20 --format csv --stats', 0,
                         'attempts 20, failed 0, readings 20\n', 'line: responses 20\n')
        self.assertEqual(done.mm, [mm] * 20)

    def test_registers_that_are_not_there_are_exception_02(self):
        self.ends(f'request 1 3 0x0300 1 --port {self.served(None, 1, 0, ["1"])}', 1, 'exception 02 (illegal data address)')


class Set(interop.Tcp, PyModbusTcp, test_servers_read.TcpSet, interop.Case):
    pass


if __name__ == '__main__':
    REASON = bring()
    if REASON is not None:
        print(f'pyModbusTCP is not there, so this is not tested: {REASON}')
        sys.exit(77)
    interop.main()
