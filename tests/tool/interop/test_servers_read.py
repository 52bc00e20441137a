#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against Modbus servers that others wrote, over serial lines and TCP; over TCP also fathom get and set."""
import interop
from interop import e2e

DATASHEET = ('0x0823', '0xDCB2', '0x0701', '0x0000')  # HPS-167S #5: 2083 mm, 723.1744
NAMES = {1: 'illegal function', 2: 'illegal data address', 3: 'illegal data value', 4: 'server device failure',
         5: 'acknowledge', 6: 'server device busy', 7: 'unknown', 8: 'memory parity error',
         10: 'gateway path unavailable', 11: 'gateway target device failed to respond'}


class Servers:
    def read(self, sensor, first, values, options='', unit=1, code=0, count=3):
        client = self.served(interop.LINES[sensor], unit, first, values)
        return self.ends(f'read {sensor} --mode modbus --port {client} --count {count} --format csv '
                         f'--stats {options}', code)

    @e2e.each(  # what stands from some register on, where it is, and what is read of that
        the_processed_distance_of_an_a16_and_not_the_real_time_one=(
            'a16', 0x0100, ['754', '751'], 'address distance_mm raw', ['5 754 754'], 5),
        nothing_in_range_of_an_a16=('a16', 0x0100, ['0xFFFD'], 'status interference distance_mm raw',
                                    ['no_target false  65533']),
        the_four_distances_of_an_a05=(
            'a05', 0x0106, ['1000', '0xFFFD', '0xFFFE', '3562'], 'probe status interference distance_mm',
            ['1 target false 1000', '2 no_target false ', '3 no_target true ', '4 target false 3562']),
        the_datasheets_measurement_of_an_hps167s=(
            'hps167s', 8, DATASHEET, 'status interference distance_mm raw magnitude ambient precision',
            ['target false 2083 2083 723.1744 1 0']),
        the_failure_of_an_hps167s=(
            'hps167s', 8, ['0xFFFF', '0', '0x00FF', '0xFFFF'],
            'status interference distance_mm raw magnitude ambient precision',
            ['fault false  65535 0.0000 255 65535']),
        an_hps167s_that_sees_nothing=('hps167s', 8, ['65530', '0x10', '0x0001', '0'],
                                      'status interference distance_mm raw', ['no_target false  65530'], 32))
    def reads(self, sensor, first, values, names, expected, unit=1):
        done = self.read(sensor, first, values, f'--address {unit}', unit)
        self.assertEqual([' '.join(row[name] for name in names.split()) for row in done.rows], expected * 3)
        self.assertEqual([int(row['sequence']) for row in done.rows], sorted([1, 2, 3] * len(expected)))
        self.assertIn(f'attempts 3, failed 0, readings {len(done.rows)}\n', done.err)
        self.assertIn('line: responses 3\n', done.err)

    @e2e.each(
        a_register_that_is_not_there_is_exception_02=('a16', 0x0300, ['1'], 2),
        registers_of_which_the_last_is_not_there_are_exception_02=('a05', 0x0106, ['1', '2', '3'], 2),
        a_register_that_breaks_is_exception_04=('hps167s', 8, ['1', '2', '!4', '3'], 4))
    def refused(self, sensor, first, values, number):
        done = self.read(sensor, first, values, code=1)
        self.assertEqual(done.rows, [])
        self.assertIn(f'refused the request: exception {number:02} ({NAMES[number]}): ', done.err)
        self.assertIn('refused the request: the same cause as before, 3 times in a row', done.err)
        self.assertIn(' exceptions 3\n', done.err)

    SILENCE = 'no byte was received'

    def test_a_unit_that_is_not_there_is_silent(self):
        for sensor, first, values in (('a16', 0x0100, ['1']), ('a05', 0x0106, ['1'] * 4),
                                      ('hps167s', 8, DATASHEET)):
            done = self.read(sensor, first, values, '--address 2 --timeout 100', code=1, count=1)
            self.assertEqual(done.rows, [])
            self.assertRegex(done.err, f'attempt 1: no response from {sensor}:2 at .*: {self.SILENCE}')


class Pymodbus(interop.PymodbusServer, Servers, interop.Case):
    pass


class Libmodbus(interop.LibmodbusServer, Servers, interop.Case):
    pass


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


class PymodbusTcp(interop.PymodbusServer, Tcp, interop.Case):
    def test_an_address_over_247(self):
        done = self.read('a16', 0x0100, ['754'], '--address 254', unit=254)
        self.assertEqual([(row['address'], row['distance_mm']) for row in done.rows], [('254', '754')] * 3)


class LibmodbusTcp(interop.LibmodbusServer, Tcp, interop.Case):
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
        self.assertEqual(done.err.count(words), 1, done.err)
        self.assertIn('the same cause as before, 3 times in a row', done.err)
        self.assertIn(' no_responses 3\n', done.err)


FACTORY = (1, 0, 0, 0, 0, 1, 1000, 0)  # 0x0200 to 0x0207: address 1, polarity 1, threshold 1 m, processed (A16 6)
NAME = 'switch-threshold'


class TcpSet:
    def test_a_setting_is_set_and_read_back(self):
        port = self.served((9600, 'none'), 1, 0x0200, FACTORY)
        self.assertRegex(self.ends(f'get a16 --port {port} {NAME}', 0).out, rf'{NAME} +1000')
        self.assertRegex(self.ends(f'set a16 --port {port} {NAME} 1200', 0).out, r'is 1200 mm \(was 1000\)')
        self.assertRegex(self.ends(f'get a16 --port {port} {NAME}', 0).out, rf'{NAME} +1200')

    def test_no_line_settings_are_told_and_none_are_changed(self):
        port = self.served((9600, 'none'), 1, 0x0200, FACTORY)
        self.assertIn(', at address 1, Modbus TCP', self.ends(f'get a16 --port {port} {NAME}', 0).out)
        # Its four registers of #2: termination and measuring on, warm-up 5 s, reconnect time 180 ms, 19200
        # baud.
        port = self.served((19200, 'even'), 1, 0x0002, (0xFFFF, 0x0500, 0x0000, 0xB401))
        self.ends(f'set hps167s --port {port} baud 115200', 1,
                  "not written: the settings of this port's line cannot be changed")

    def test_no_server_there_is_exit_status_1(self):
        self.ends(f'set a16 --port tcp:127.0.0.1:1 {NAME} 1200', 1,
                  'tcp:127.0.0.1:1: Connection refused: nothing serves this port', out='')


class PymodbusTcpSet(interop.Tcp, interop.PymodbusServer, TcpSet, interop.Case):
    pass


class LibmodbusTcpSet(interop.Tcp, interop.LibmodbusServer, TcpSet, interop.Case):
    pass


if __name__ == '__main__':
    interop.main()
