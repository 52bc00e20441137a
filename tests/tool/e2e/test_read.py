#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against fathom sim: the members of a reading, the pace, and what reaches the port. (What each sensor
prints in each format: test_tool_read.c.)"""
import datetime
import termios
import time

import e2e

COMMON = ['name', 'model', 'mode', 'address', 'probe', 'sequence', 'time_us', 'utc', 'status', 'interference',
          'distance_mm', 'raw']
OPTICS = ['magnitude', 'ambient', 'precision']


class Json(e2e.Case):
    @e2e.each(
        the_four_probes_of_an_a05_share_sequence_and_time=('a05', 'auto', None),
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


class Choices(e2e.Case):
    def test_what_an_hps167s_says_to_another_client_is_no_measurement(self):
        device, reader = self.beside('read hps167s:1:auto --count 1 --timeout 1000 --format csv')
        device.write(e2e.registers(1, 77))  # the response to #4
        self.ends(reader, 1, 'Modbus frames were received, but no measurement of hps167s:1. If the sensor does not send '
                             'automatically, use --mode modbus')

    def test_the_simulated_hps167s_that_sends_by_itself_names_the_command_that_reads_it(self):
        self.assertIn('fathom read hps167s:7:auto --port', self.sim('hps167s:7:auto').end().err)


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


class Clients(e2e.Case):
    def test_a_simulated_sensor_outlives_its_clients(self):
        sim = self.sim('hps167s:3 --distance 500')
        for _ in range(3):
            self.assertEqual(len(self.read_json(f'hps167s --address 3 --port {sim} --count 1')), 1)
        self.assertEqual(sim.end().code, 0)

    def test_settings_that_are_not_the_factorys_reach_the_port(self):
        device, _ = self.beside('read a16 --baud 115200 --parity odd --format csv')
        self.assertEqual(device.baud(), termios.B115200)
        # a pseudo terminal keeps PARODD, though not PARENB
        self.assertTrue(termios.tcgetattr(device.slave)[2] & termios.PARODD)

    def test_two_stop_bits_reach_the_port(self):
        for number in (1, 2):
            device, _ = self.beside(f'read hps167s --stop-bits {number}')
            device.read(8)  # a request
            self.assertEqual(device.baud(), termios.B19200)
            self.assertEqual(bool(termios.tcgetattr(device.slave)[2] & termios.CSTOPB), number == 2)


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
