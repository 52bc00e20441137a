#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read over TCP against Modbus servers that others wrote: what it reads over serial lines."""
import interop
from interop import e2e
from test_servers_read import DATASHEET, NAMES, Servers


class Tcp(interop.Tcp, Servers):
    SILENCE = 'the connection is open, but nothing was received. Check --address'

    def test_a_name_instead_of_an_address(self):
        """localhost may be ::1 first, where nothing serves this port."""
        number = self.served((19200, 'even'), 1, 8, DATASHEET).rsplit(':', 1)[1]
        rows = self.read_json(f'hps167s --port tcp:localhost:{number} --count 2')
        self.assertEqual([row['distance_mm'] for row in rows], [2083, 2083])

    def test_many_readings_through_one_connection(self):
        done = self.read('hps167s', 8, DATASHEET, count=200)
        self.assertEqual(done.mm, ['2083'] * 200)
        self.assertIn('attempts 200, failed 0, readings 200\n', done.err)
        self.assertIn('line: responses 200\n', done.err)


class Pymodbus(interop.PymodbusServer, Tcp, interop.Case):
    def test_an_address_over_247(self):
        done = self.read('a16', 0x0100, ['754'], '--address 254', unit=254)
        self.assertEqual([(row['address'], row['distance_mm']) for row in done.rows], [('254', '754')] * 3)


class Libmodbus(interop.LibmodbusServer, Tcp, interop.Case):
    def test_a_unit_that_is_not_there_is_silent(self):
        """Over TCP libmodbus answers for every unit, with the unit that was asked."""
        row, = self.read('hps167s', 8, DATASHEET, '--address 2', count=1).rows
        self.assertEqual((row['address'], row['distance_mm']), ('2', '2083'))

    @e2e.each(**{f'every_exception_that_libmodbus_can_send_has_its_number_{number:02}': number
                 for number in NAMES
                 if number < 10})
    def numbered(self, number):
        self.refused('hps167s', 8, [f'!{number}', '0', '0', '0'], number)

    @e2e.each(a_gateways_exceptions_are_no_response_10=10, a_gateways_exceptions_are_no_response_11=11)
    def gateway(self, number):
        done = self.read('hps167s', 8, [f'!{number}', '0', '0', '0'], '--timeout 100', code=1)
        self.assertEqual(done.rows, [])
        words = f'the gateway responds with exception {number} ({NAMES[number]}). Check '
        self.assertEqual(done.err.count(words), 3, done.err)
        self.assertIn(' no_responses 3\n', done.err)


if __name__ == '__main__':
    interop.main()
