#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against Modbus servers that others wrote."""
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
    @e2e.each(**{f'every_exception_that_libmodbus_can_send_has_its_number_{number:02}': number
                 for number in NAMES})
    def numbered(self, number):
        self.refused('hps167s', 8, [f'!{number}', '0', '0', '0'], number)


if __name__ == '__main__':
    interop.main()
