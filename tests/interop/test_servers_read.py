#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against Modbus servers that others wrote."""
import interop

DATASHEET = ('0x0823', '0xDCB2', '0x0701', '0x0000')  # HPS-167S #5: 2083 mm, 723.1744


class Servers:
    def read(self, sensor, first, values, *arguments, unit=1, code=0, count=3):
        client = self.served(interop.LINES[sensor], unit, first, values)
        done = self.run_fathom('read', sensor, *arguments, '--mode', 'modbus', '--port', client, '--count', count,
                               '--format', 'csv')
        self.assertEqual(done.code, code, done.err)
        return [row.split(',') for row in done.out.splitlines()[1:]], done.err

    def test_the_processed_distance_of_an_a16_and_not_the_real_time_one(self):
        rows, err = self.read('a16', 0x0100, ['754', '751'], '--address', '5', unit=5)
        self.assertEqual([(row[2], row[4], row[9], row[10]) for row in rows],
                         [('5', str(sequence), '754', '754') for sequence in (1, 2, 3)])
        self.assertIn('attempts 3, failed 0, readings 3\nfathom: line: answers 3\n', err)

    def test_nothing_in_range_of_an_a16(self):
        rows, _ = self.read('a16', 0x0100, ['0xFFFD'])
        self.assertEqual([(row[7], row[8], row[9], row[10]) for row in rows], [('no_target', 'false', '', '65533')] * 3)

    def test_the_four_distances_of_an_a05(self):
        rows, _ = self.read('a05', 0x0106, ['1000', '0xFFFD', '0xFFFE', '3562'])
        self.assertEqual([(row[3], row[7], row[8], row[9]) for row in rows],
                         [('1', 'target', 'false', '1000'), ('2', 'no_target', 'false', ''),
                          ('3', 'no_target', 'true', ''), ('4', 'target', 'false', '3562')] * 3)

    def test_the_datasheets_measurement_of_an_hps167s(self):
        rows, _ = self.read('hps167s', 0x0008, DATASHEET)
        self.assertEqual([row[7:] for row in rows], [['target', 'false', '2083', '2083', '723.1744', '1', '0']] * 3)

    def test_the_failure_of_an_hps167s(self):
        rows, _ = self.read('hps167s', 0x0008, ['0xFFFF', '0', '0x00FF', '0xFFFF'])
        self.assertEqual([row[7:] for row in rows], [['fault', 'false', '', '65535', '0.0000', '255', '65535']] * 3)

    def test_an_hps167s_that_sees_nothing(self):
        rows, _ = self.read('hps167s', 0x0008, ['65530', '0x10', '0x0001', '0'], '--address', '32', unit=32)
        self.assertEqual([row[7:11] for row in rows], [['no_target', 'false', '', '65530']] * 3)

    def refused(self, sensor, first, values, number, name):
        rows, err = self.read(sensor, first, values, code=1)
        self.assertEqual(rows, [])
        words = f'address 1 refused: exception {number} ({name}): '
        self.assertEqual(err.count(words), 3, err)
        self.assertIn('line: exceptions 3\n', err)

    def test_a_register_that_is_not_there_is_exception_02(self):
        self.refused('a16', 0x0300, ['1'], '02', 'illegal data address')

    def test_registers_of_which_the_last_is_not_there_are_exception_02(self):
        self.refused('a05', 0x0106, ['1', '2', '3'], '02', 'illegal data address')

    def test_a_register_that_breaks_is_exception_04(self):
        self.refused('hps167s', 0x0008, ['1', '2', '!4', '3'], '04', 'device failure')

    def test_a_unit_that_is_not_there_is_silent(self):
        for sensor, first, values in (('a16', 0x0100, ['1']), ('a05', 0x0106, ['1'] * 4), ('hps167s', 8, DATASHEET)):
            rows, err = self.read(sensor, first, values, '--address', '2', '--timeout', '100', code=1, count=1)
            self.assertEqual(rows, [])
            self.assertIn('attempt 1: no answer from address 2: nothing was heard at all', err)


class Pymodbus(interop.PymodbusServer, Servers, interop.Case):
    pass


class Libmodbus(interop.LibmodbusServer, Servers, interop.Case):
    def test_every_exception_that_libmodbus_can_send_has_its_number(self):
        for number, name in ((1, 'illegal function'), (2, 'illegal data address'), (3, 'illegal data value'),
                             (4, 'device failure'), (5, 'acknowledge'), (6, 'device busy'), (7, 'unknown'),
                             (8, 'memory parity error'), (10, 'gateway path unavailable'),
                             (11, 'gateway target silent')):
            self.refused('hps167s', 8, [f'!{number}', '0', '0', '0'], f'{number:02}', name)


if __name__ == '__main__':
    interop.main()
