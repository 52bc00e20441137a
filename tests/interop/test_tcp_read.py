#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read over TCP against Modbus servers that others wrote: what it reads over serial lines."""
import interop
from test_servers_read import DATASHEET, Servers


class Tcp(interop.Tcp, Servers):
    silent = ('a16', 0x0100, ['1']), ('a05', 0x0106, ['1'] * 4), ('hps167s', 8, DATASHEET)

    def test_a_name_instead_of_an_address(self):
        """localhost may be ::1 first, where nothing serves this port."""
        port = self.served((19200, 'even'), 1, 8, DATASHEET).rsplit(':', 1)[1]
        rows = self.read_json('hps167s', '--port', f'tcp:localhost:{port}', '--count', '2')
        self.assertEqual([row['distance_mm'] for row in rows], [2083, 2083])

    def test_many_readings_through_one_connection(self):
        rows, err = self.read('hps167s', 0x0008, DATASHEET, count=200)
        self.assertEqual([row[9] for row in rows], ['2083'] * 200)
        self.assertIn('attempts 200, failed 0, readings 200\nfathom: line: answers 200\n', err)


class Pymodbus(interop.PymodbusServer, Tcp, interop.Case):
    def test_a_unit_that_is_not_there_is_silent(self):
        for sensor, first, values in self.silent:
            rows, err = self.read(sensor, first, values, '--address', '2', '--timeout', '100', code=1, count=1)
            self.assertEqual(rows, [])
            self.assertIn('attempt 1: no answer from address 2: the connection stands, but nothing came back; check '
                          '--address, ', err)

    def test_an_address_over_247(self):
        rows, _ = self.read('a16', 0x0100, ['754'], '--address', '254', unit=254)
        self.assertEqual([(row[2], row[9]) for row in rows], [('254', '754')] * 3)


class Libmodbus(interop.LibmodbusServer, Tcp, interop.Case):
    def test_a_unit_that_is_not_there_is_silent(self):
        """Over TCP libmodbus answers for every unit, with the unit that was asked."""
        for sensor, first, values in self.silent[2:]:
            rows, _ = self.read(sensor, first, values, '--address', '2', count=1)
            self.assertEqual([(row[2], row[9]) for row in rows], [('2', '2083')])

    def test_every_exception_that_libmodbus_can_send_has_its_number(self):
        for number, name in ((1, 'illegal function'), (2, 'illegal data address'), (3, 'illegal data value'),
                             (4, 'device failure'), (5, 'acknowledge'), (6, 'device busy'), (7, 'unknown'),
                             (8, 'memory parity error')):
            self.refused('hps167s', 8, [f'!{number}', '0', '0', '0'], f'{number:02}', name)

    def test_a_gateways_exceptions_are_no_answer(self):
        for number, name in ((10, 'gateway path unavailable'), (11, 'gateway target silent')):
            rows, err = self.read('hps167s', 8, [f'!{number}', '0', '0', '0'], '--timeout', '100', code=1)
            self.assertEqual(rows, [])
            words = f'no answer from address 1: the gateway says exception {number} ({name}); check '
            self.assertEqual(err.count(words), 3, err)
            self.assertIn('line: requests without an answer 3\n', err)


if __name__ == '__main__':
    interop.main()
