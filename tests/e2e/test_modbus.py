#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Against Modbus that we did not write: fathom read with the servers of pymodbus and libmodbus, and mbpoll and
pymodbus as clients of fathom sim."""
import os
import re
import subprocess
import sys
import time

from pymodbus.client import ModbusSerialClient

import e2e

DATASHEET = ('0x0823', '0xDCB2', '0x0701', '0x0000')  # HPS-167S #5: 2083 mm, 723.1744


class Servers:
    """The same tests for both servers. On their side of the pseudo terminal there is no parity: pyserial takes
    it for an error that such a terminal does not keep it."""

    def pair(self):
        """Two ends of a line."""
        ends = [self.path('server'), self.path('client')]
        self.start('socat', *(f'pty,raw,echo=0,link={end}' for end in ends))
        deadline = time.monotonic() + e2e.PATIENCE
        while not all(os.path.exists(end) for end in ends):
            self.assertLess(time.monotonic(), deadline, 'socat did not make its terminals')
            time.sleep(0.01)
        return ends

    def read(self, first, values, *arguments, baud=9600, unit=1, code=0):
        server, client = self.pair()
        self.serve(server, baud, unit, first, values).expect('^ready$')
        done = self.run_fathom('read', *arguments, '--mode', 'modbus', '--port', client, '--count', '3',
                               '--format', 'csv')
        self.assertEqual(done.code, code, done.err)
        return [row.split(',') for row in done.out.splitlines()[1:]], done.err

    def test_the_processed_distance_of_an_a16_and_not_the_real_time_one(self):
        rows, err = self.read(0x0100, ['754', '751'], 'a16', '--address', '5', unit=5)
        self.assertEqual([(row[2], row[4], row[9], row[10]) for row in rows],
                         [('5', str(sequence), '754', '754') for sequence in (1, 2, 3)])
        self.assertIn('attempts 3, failed 0, readings 3\nfathom: line: answers 3\n', err)

    def test_the_four_distances_of_an_a05(self):
        rows, _ = self.read(0x0106, ['1000', '0xFFFD', '0xFFFE', '3562'], 'a05')
        self.assertEqual([(row[3], row[7], row[8], row[9]) for row in rows],
                         [('1', 'target', 'false', '1000'), ('2', 'no_target', 'false', ''),
                          ('3', 'no_target', 'true', ''), ('4', 'target', 'false', '3562')] * 3)

    def test_the_datasheets_measurement_of_an_hps167s(self):
        rows, _ = self.read(0x0008, DATASHEET, 'hps167s', baud=19200)
        self.assertEqual([row[7:] for row in rows], [['target', 'false', '2083', '2083', '723.1744', '1', '0']] * 3)

    def test_the_failure_of_an_hps167s(self):
        rows, _ = self.read(0x0008, ['0xFFFF', '0', '0x00FF', '0xFFFF'], 'hps167s', baud=19200)
        self.assertEqual([row[7:] for row in rows], [['fault', 'false', '', '65535', '0.0000', '255', '65535']] * 3)

    def test_a_register_that_is_not_there_is_exception_02(self):
        rows, err = self.read(0x0300, ['1'], 'a16', code=1)
        self.assertEqual(rows, [])
        self.assertEqual(err.count('address 1 refused: exception 02 (illegal data address); check that it is a16\n'), 3)
        self.assertIn('line: exceptions 3\n', err)

    def test_a_unit_that_is_not_there_is_silent(self):
        rows, err = self.read(0x0008, DATASHEET, 'hps167s', '--address', '2', '--timeout', '150', code=1)
        self.assertEqual(rows, [])
        self.assertEqual(err.count('no answer from address 2'), 3)


class Pymodbus(Servers, e2e.Case):
    def serve(self, port, baud, unit, first, values):
        return self.start(sys.executable, os.path.join(e2e.HERE, 'modbus_server.py'), port, baud, unit,
                          *(f'{first + i}={value}' for i, value in enumerate(values)))


class Libmodbus(Servers, e2e.Case):
    def serve(self, port, baud, unit, first, values):
        flags = subprocess.run(['pkg-config', '--cflags', '--libs', 'libmodbus'], stdout=subprocess.PIPE, text=True,
                               check=True).stdout.split()
        program = self.path('modbus_server')
        subprocess.run(['cc', '-o', program, os.path.join(e2e.HERE, 'modbus_server.c'), *flags], check=True)
        return self.start(program, port, baud, unit, first, *values)


class Mbpoll(e2e.Case):
    """What it has to say is on stdout and on stderr."""

    def poll(self, port, first, count, *line):
        done = self.start('mbpoll', '-m', 'rtu', *line, '-t', '4:hex', '-0', '-r', first, '-c', count, '-1',
                          port).finish()
        return done.code, re.findall(r'^\[(\d+)\]:\s+0x([0-9A-F]{4})', done.out, re.M), done.err

    def test_it_reads_the_simulated_hps167s(self):
        sim = self.sim('hps167s', '--distance', '2083', '--link', self.path('tof'))
        line = ('-a', '1', '-b', '19200', '-P', 'even')
        self.assertEqual(self.poll(self.path('tof'), 8, 4, *line),
                         (0, [('8', '0823'), ('9', 'DCB2'), ('10', '0701'), ('11', '0000')], ''))
        self.assertEqual(sim.end().code, 0)

    def test_it_is_told_exception_02_for_a_wrong_length(self):
        sim = self.sim('hps167s', '--distance', '2083')
        code, values, said = self.poll(sim.port, 8, 3, '-a', '1', '-b', '19200', '-P', 'even')
        self.assertEqual((code, values), (1, []))
        self.assertIn('Illegal data address', said)

    def test_it_reads_the_simulated_a16_and_a05(self):
        for device, first, values in (('a16:9:modbus', 0x0100, ['02F2']), ('a05:9:modbus', 0x0106, ['02F2'] * 4),
                                      ('a05:9:modbus', 0x0010, ['02F2'] * 4)):
            with self.subTest(device):
                sim = self.sim(device, '--distance', '754')
                code, got, said = self.poll(sim.port, first, len(values), '-a', '9', '-b', '9600', '-P', 'none')
                self.assertEqual((code, said), (0, ''))
                self.assertEqual([value for _, value in got], values)


class PymodbusClient(e2e.Case):
    def client(self, sim, **settings):
        client = ModbusSerialClient(sim.port, timeout=e2e.PATIENCE / 4, **settings)
        self.addCleanup(client.close)
        self.assertTrue(client.connect())
        return client

    def test_it_reads_the_simulated_hps167s_and_its_exceptions(self):
        client = self.client(self.sim('hps167s:7', '--distance', '2083'), baudrate=19200)
        self.assertEqual(client.read_holding_registers(8, 4, slave=7).registers, [int(v, 16) for v in DATASHEET])
        self.assertEqual(client.read_holding_registers(8, 2, slave=7).exception_code, 2)
        self.assertEqual(client.read_input_registers(8, 4, slave=7).exception_code, 1)

    def test_it_reads_the_simulated_a05(self):
        client = self.client(self.sim('a05::modbus', '--distance', '1000,2000,1953,3562'), baudrate=9600)
        self.assertEqual(client.read_holding_registers(0x0107, 3, slave=1).registers, [2000, 1953, 3562])
        self.assertEqual(client.read_holding_registers(0x0200, 1, slave=1).registers, [1])


if __name__ == '__main__':
    e2e.main()
