#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against fathom sim: every sensor and mode, every format, counts and pace."""
import datetime
import re
import termios
import time

import e2e

COMMON = ['name', 'model', 'mode', 'address', 'probe', 'sequence', 'time_us', 'utc', 'status', 'interference',
          'distance_mm', 'raw']
OPTICS = ['magnitude', 'ambient', 'precision']


def target(mm):
    return 'target', False, mm, mm


# sensor, mode, what sim is asked to see; what comes back: (status, interference, distance, raw) a probe
NO_TARGET, INTERFERENCE = ('no_target', False, None, 0xFFFD), ('no_target', True, None, 0xFFFE)
SEEN = [
    ('a16 auto 1953', [target(1953)]),
    ('a16 auto 511', [target(511)]),  # FF 01 FF FF: out of step it would be 65281
    ('a16 auto no-target', [NO_TARGET]),
    ('a16 auto interference', [INTERFERENCE]),
    ('a16 modbus 754', [target(754)]),
    ('a05 auto 1000,2000,1953,3562', [target(mm) for mm in (1000, 2000, 1953, 3562)]),
    # out of step by six it would be 1339 2047 1000 2000
    ('a05 auto 1000,2000,2047,1339', [target(mm) for mm in (1000, 2000, 2047, 1339)]),
    ('a05 auto 1000', [target(1000)] * 4),
    ('a05 modbus 316,no-target,interference,4500', [target(316), NO_TARGET, INTERFERENCE, target(4500)]),
    ('hps167s modbus 2083', [target(2083)]),
    ('hps167s modbus no-target', [('no_target', False, None, 65530)]),
    ('hps167s auto 2083', [target(2083)]),
    ('hps167s modbus fault', [('fault', False, None, 65535)]),
]


class Values(e2e.Case):
    """Exactly what the simulated sensor sees, in every mode; nothing in range and a fault are no failures."""

    @e2e.each(**{re.sub('[^a-z0-9]', '_', row[0]): row for row in SEEN})
    def seen(self, words, expected):
        sensor, mode, distance = words.split()
        sim = self.sim(f'{sensor}::{mode} --distance {distance}')
        got = [(one['probe'], one['sequence'], one['status'], one['interference'], one['distance_mm'],
                one['raw'])
               for one in self.read_json(f'{sensor} --mode {mode} --port {sim} --count 2')]
        first = got[0][1]
        self.assertEqual(got, [(probe, sequence, *one) for sequence in (first, first + 1)
                               for probe, one in enumerate(expected, 1)])


class FirstContact(e2e.Case):
    """3 and 4: one odd probe does not hide the others, and 0 is not taken for "nothing in range"."""

    def test_an_odd_probe_is_told_and_the_three_others_are_read_each_time(self):
        sim = self.sim('a05 --distance 1000,2000,7000,3000')
        done = self.ends(f'read a05 --port {sim} --count 3 --format csv --stats', 1, 'attempts 3, failed 3, readings 9\n')
        self.assertEqual([(row['probe'], row['distance_mm']) for row in done.rows],
                         [('1', '1000'), ('2', '2000'), ('4', '3000')] * 3)
        self.assertEqual(re.findall(r'attempt (\d): .*: (probe 3: 7000 is no distance from 1 to 6000 mm)\. '
                                    r'If this probe is not fitted, leave it out', done.err),
                         [(n, 'probe 3: 7000 is no distance from 1 to 6000 mm') for n in '123'])

    @e2e.each(auto='auto', modbus='modbus', dyp='dyp')
    def probes(self, mode):
        """An odd probe that is left out is no failure."""
        sim = self.sim(f'a05::{mode} --distance 1000,2000,7000,3000')
        got = self.read_json(f'a05 --mode {mode} --port {sim} --count 3 --probes 1,2,4')
        self.assertEqual([(one['probe'], one['raw']) for one in got], [(1, 1000), (2, 2000), (4, 3000)] * 3)

    # what is sent, the option, status: kind and interference
    @e2e.each(
        a_zero_is_unknown=('0', '', 'unknown', False, 1),
        a_zero_that_is_no_target=('0', '--means 0=no-target', 'no_target', False, 0),
        a_zero_that_is_too_near=('0', '--means fffd=fault,0=too-near', 'too_near', False, 0),
        fffd_that_is_unknown=('no-target', '--means fffd=unknown', 'unknown', False, 1),
        fffe_that_is_a_fault=('interference', '--means fffe=fault', 'fault', False, 0),
        ffff_that_is_interference=('65535', '--means ffff=interference', 'no_target', True, 0))
    def means(self, sent, option, status, interference, code):
        """A sensor that gave nothing but unknown values gave no good reading."""
        for device, reader in (('a16', 'a16'), ('a16::modbus', 'a16 --mode modbus')):
            sim = self.sim(f'{device} --distance {sent}')
            one, = self.ends(f'read {reader} --port {sim} --count 1 --format json {option}', code).json
            self.assertEqual((one['status'], one['interference'], one['distance_mm']),
                             (status, interference, None))

    @e2e.each(
        refused_by_default=('65535', '', r'65535 \(hex FFFF\) has no known meaning. If you know it, use --means FFFF='),
        refused_on_request=('no-target', '--means fffd=refused', r'65533 \(hex FFFD\) has no known meaning. If you know it, use --means FFFD='))
    def refused(self, sent, option, words):
        sim = self.sim(f'a16 --distance {sent}')
        self.assertRegex(self.ends(f'read a16 --port {sim} --count 1 {option}', 1).err, words)

    def test_a_sensor_that_says_nothing_in_the_time_that_it_has_is_a_failure(self):
        self.ends(f'read a16 --port {self.device()} --duration 1 --stats', 1, 'attempts 0, failed 0, readings 0\n')

    def test_one_good_sensor_does_not_make_up_for_another_that_gave_nothing_good(self):
        sim = self.sim('a16:1:modbus,distance=0 a05:2:modbus,distance=1000')
        self.ends(f'read a16:1 a05:2 --port {sim} --count 1 --stats', 1, 'attempts 2, failed 0, readings 5\n')


class Json(e2e.Case):
    @e2e.each(
        a16_auto_has_no_address=('a16', 'auto', None),
        a16_modbus_has_the_address=('a16', 'modbus', 254),
        the_four_probes_of_an_a05_share_sequence_and_time=('a05', 'auto', None),
        the_four_probes_of_an_a05_response_share_sequence_and_time=('a05', 'modbus', 9),
        an_hps167s_has_its_optics_too_and_the_magnitude_exactly=('hps167s', 'modbus', 32),
        an_hps167s_that_is_not_asked_has_them_and_its_address=('hps167s', 'auto', 7))
    def members(self, sensor, mode, address):
        sim = self.sim(f'{sensor}:{address or ""}:{mode} --distance 1234')
        began = time.time()
        options = '' if address is None else f'--mode {mode} --address {address}'
        done = self.ends(f'read {sensor} --port {sim} --count 3 --format json {options}', 0)
        ended = time.time()
        probes = 4 if sensor == 'a05' else 1
        self.assertEqual(len(done.json), 3 * probes)
        for one in done.json:
            self.assertEqual(list(one), COMMON + (OPTICS if sensor == 'hps167s' else []))
            self.assertEqual((one['model'], one['mode'], one['address']), (sensor, mode, address))
            self.assertEqual((one['status'], one['distance_mm'], one['raw']), ('target', 1234, 1234))
            self.assertIs(one['interference'], False)
            for name in ('probe', 'sequence', 'time_us', 'raw', 'distance_mm'):
                self.assertIs(type(one[name]), int, name)
            self.assertRegex(one['utc'], r'^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z$')
            at = datetime.datetime.fromisoformat(one['utc'].replace('Z', '+00:00')).timestamp()
            self.assertTrue(began <= at <= ended, (began, one['utc'], ended))
            self.assertTrue(0 < one['time_us'] < (ended - began) * 1e6)
        first = done.json[0]['sequence']
        times = [one['time_us'] for one in done.json[::probes]]
        self.assertEqual(times, sorted(times))
        self.assertEqual([(one['probe'], one['sequence'], one['time_us']) for one in done.json],
                         [(probe, first + i, times[i]) for i in range(3) for probe in range(1, probes + 1)])
        if sensor == 'hps167s':
            self.assertEqual(done.out.count('"magnitude":723.1744,"ambient":1,"precision":0}\n'), 3)


class Formats(e2e.Case):
    def test_csv_has_one_header_line_and_the_values_of_json(self):
        sim = self.sim('a05::modbus --distance 1000,no-target,interference,4500')
        done = self.ends(f'read a05 --mode modbus --port {sim} --count 2 --format csv', 0)
        header, *rows = done.out.splitlines()
        self.assertEqual(header, ','.join(COMMON))
        expected = ['a05:1,a05,modbus,1,1,{0},T,U,target,false,1000,1000',
                    'a05:1,a05,modbus,1,2,{0},T,U,no_target,false,,65533',
                    'a05:1,a05,modbus,1,3,{0},T,U,no_target,true,,65534',
                    'a05:1,a05,modbus,1,4,{0},T,U,target,false,4500,4500']
        got = [re.sub(r',\d+,[-\dT:.]+Z,', ',T,U,', row) for row in rows]
        self.assertEqual(got, [row.format(sequence) for sequence in (1, 2) for row in expected])

    @e2e.each(
        csv_of_a_sensor_with_optics=('hps167s', 2083, OPTICS,
                                     r'hps167s:1,hps167s,modbus,1,1,1,\d+,[^,]+Z,target,false,2083,2083,723\.1744,1,0'),
        csv_of_a_sensor_that_sends_by_itself_has_no_address=(
            'a16', 754, [], r'a16,a16,auto,,1,1,\d+,[^,]+Z,target,false,754,754'))
    def csv(self, sensor, distance, more, expected):
        sim = self.sim(f'{sensor} --distance {distance}')
        header, row = self.ends(f'read {sensor} --port {sim} --count 1 --format csv', 0).out.splitlines()
        self.assertEqual(header, ','.join(COMMON + more))
        self.assertRegex(row, f'^{expected}$')

    @e2e.each(
        text_is_the_default_and_in_mm_and_m=('a16', '754', '', 'a16     754 mm    0.754 m'),
        text_of_four_probes=('a05', '1000,20,no-target,interference', '--format text',
                             'a05 probe 1    1000 mm    1.000 m', 'a05 probe 2      20 mm    0.020 m',
                             'a05 probe 3  no_target',
                             'a05 probe 4  no_target (interference)'),
        text_of_what_is_no_distance=(
            'a05', '0,65533,1000,1000', '--means fffd=too-near',
            'a05 probe 1  unknown: the value 0 has no known meaning (--means)',
            'a05 probe 2  too_near', 'a05 probe 3    1000 mm    1.000 m',
            'a05 probe 4    1000 mm    1.000 m'),
        text_of_an_hps167s=('hps167s', '17999', '',
                            'hps167s   17999 mm   17.999 m  magnitude 723.1744  ambient 1  precision 0'),
        text_of_a_fault=('hps167s', 'fault', '', 'hps167s  fault: the sensor reports a fault'))
    def text(self, sensor, distance, options, *expected):
        sim = self.sim(f'{sensor} --distance {distance}')
        done = self.ends(f'read {sensor} --port {sim} --count 1 {options}', 0)
        self.assertEqual(re.sub(r'^ *\d+\.\d{3} s  ', '', done.out, flags=re.M).splitlines(), [*expected])


class Choices(e2e.Case):
    @e2e.each(
        real_time_by_rx_needs_a_port_that_can_hold_its_tx_low=(
            'a16 --value real-time', 'fathom: a16: this port cannot hold its TX low (a break)'),
        an_a05_needs_it_too=(
            'a05 --value real-time', 'fathom: a05: this port cannot hold its TX low (a break)'),
        without_the_option_rx_is_left_alone=('a16 --timeout 300', 'no byte was received'),
        an_hps167s_that_is_not_asked_is_sent_nothing=(
            'hps167s:1:auto --timeout 300', 'no byte was received. Check the power and whether A and B are swapped'))
    def silent(self, line, said):
        """A byte 0 would stand for a break."""
        device, reader = self.beside(f'read {line} --count 1')
        self.ends(reader, 1, said, out='')
        self.assertEqual(device.rest(), b'')

    def test_what_an_hps167s_says_to_another_client_is_no_measurement(self):
        device, reader = self.beside('read hps167s:1:auto --count 1 --timeout 1000 --format csv')
        device.write(e2e.registers(1, 77))  # the response to #4
        self.ends(reader, 1, 'Modbus frames were received, but no measurement of hps167s:1. If the sensor does not send '
                             'automatically, use --mode modbus')

    def test_the_simulated_hps167s_that_sends_by_itself_names_the_command_that_reads_it(self):
        self.assertIn('fathom read hps167s:7:auto --port', self.sim('hps167s:7:auto').end().err)

    def test_what_sends_by_itself_needs_a_serial_port(self):
        self.ends('read hps167s:1:auto --port tcp:127.0.0.1:1', 2, 'needs a serial port')

    def test_the_temperature_stands_in_each_reading(self):
        sim = self.sim('hps167s --distance 500')  # 77 degrees Fahrenheit
        objects = self.read_json(f'hps167s --temperature --port {sim} --count 5')
        self.assertEqual([one['temperature_degc'] for one in objects], [25.0] * 5)


class Pace(e2e.Case):
    def test_without_a_count_it_goes_on(self):
        reader = self.fathom(f'read hps167s --port {self.sim("hps167s --distance 500")} --format json')
        for sequence in range(1, 21):  # 54 a second
            reader.expect(rf'"sequence":{sequence},')
        self.ends(reader.end(), 0)

    def test_lines_are_flushed_at_once_to_a_pipe(self):
        reader = self.fathom(f'read a16 --port {self.sim("a16 --distance 500")} --interval 2100000')
        reader.expect('500 mm')
        self.assertFalse(reader.has_ended())

    def test_an_interval_between_requests_is_kept(self):
        sim = self.sim('hps167s --distance 500')
        objects = self.read_json(f'hps167s --port {sim} --count 4 --interval 250')
        self.assertEqual([one['sequence'] for one in objects], [1, 2, 3, 4])
        self.assertGreaterEqual(objects[3]['time_us'] - objects[0]['time_us'], 2 * 250000)

    def test_an_interval_between_frames_drops_what_comes_meanwhile_and_counts_it(self):
        sim = self.sim('a16 --distance 500')  # a frame every 100 ms
        done = self.ends(f'read a16 --port {sim} --count 3 --interval 400 --format csv --stats', 0,
                         'attempts 3, failed 0, readings 3')
        first, _, last = done.rows
        self.assertGreaterEqual(int(last['time_us']) - int(first['time_us']), 600000)
        self.assertGreaterEqual(int(last['sequence']) - int(first['sequence']), 4)
        self.assertGreater(int(re.search(r'stream: frames (\d+)', done.err)[1]), 5)

    def test_a_frame_of_four_probes_is_one_attempt_and_never_split_by_an_interval(self):
        sim = self.sim('a05 --distance 1000,2000,1953,3562')
        objects = self.read_json(f'a05 --port {sim} --count 2 --interval 700')
        self.assertEqual([one['probe'] for one in objects], [1, 2, 3, 4, 1, 2, 3, 4])
        self.assertEqual(len({one['sequence'] for one in objects}), 2)

    def test_nothing_is_told_at_the_end_without_stats(self):
        sim = self.sim('a05::modbus --distance 1000')
        done = self.run_fathom(f'read a05 --mode modbus --port {sim} --count 2')
        self.assertEqual(done.err, '')


class Clients(e2e.Case):
    def test_a_simulated_sensor_outlives_its_clients(self):
        sim = self.sim('hps167s:3 --distance 500')
        for _ in range(3):
            self.assertEqual(len(self.read_json(f'hps167s --address 3 --port {sim} --count 1')), 1)
        self.assertEqual(sim.end().code, 0)

    def test_a_modbus_request_ends_the_automatic_output_of_an_a16(self):
        sim = self.sim('a16 --distance 754')
        self.assertEqual(self.read_json(f'a16 --port {sim} --count 1')[0]['mode'], 'auto')
        asked, = self.read_json(f'a16 --mode modbus --port {sim} --count 1')
        self.assertEqual((asked['mode'], asked['distance_mm']), ('modbus', 754))
        self.assertEqual(self.read_json(f'a16 --port {sim} --count 1 --timeout 400', code=1), [])

    def test_settings_that_are_not_the_factorys_reach_the_port(self):
        device, _ = self.beside('read a16 --baud 115200 --parity odd --format csv')
        self.assertEqual(device.baud(), termios.B115200)
        # a pseudo terminal keeps PARODD, though not PARENB
        self.assertTrue(termios.tcgetattr(device.slave)[2] & termios.PARODD)

    @e2e.each(two_stop_bits_reach_the_port_of_read='read', two_stop_bits_reach_the_port_of_get='get',
              two_stop_bits_reach_the_port_of_scan='scan')
    def stop_bits(self, command):
        what = {'read': 'read hps167s', 'get': 'get hps167s baud', 'scan': 'scan --listen 1 --baud 19200'}[command]
        for number in (1, 2):
            device, _ = self.beside(f'{what} --stop-bits {number}')
            device.read(8)  # a request
            self.assertEqual(device.baud(), termios.B19200)
            self.assertEqual(bool(termios.tcgetattr(device.slave)[2] & termios.CSTOPB), number == 2)


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
