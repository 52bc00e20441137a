#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several sensors on one pair: fathom read in one loop, also at different line settings; and
examples/bus.c. (Who is left alone: test_tool_read.c.) It needs real time: CTest runs one such file at a time."""
import collections
import os
import re
import termios

import e2e
from e2e import ASK_A16, ASK_HPS, SAYS_754, SAYS_2083

BUILD = os.environ.get('FATHOM_BUILD') or os.path.dirname(e2e.FATHOM)
BUS = 'a16:1:modbus a05:2:modbus hps167s:7'
SEEN = 'a16:1:modbus,distance=1953 a05:2:modbus,distance=1000,2000,no-target,3562 hps167s:7,distance=2083'


class Read(e2e.Case):
    def test_three_models_with_two_line_settings_are_read_in_one_loop(self):
        done = self.ends(f'read {BUS} --port {self.sim(SEEN)} --count 4 --format json', 0)
        got = collections.Counter((one['model'], one['mode'], one['address'], one['probe'], one['status'],
                                   one['distance_mm']) for one in done.json)
        self.assertEqual(got, {('a16', 'modbus', 1, 1, 'target', 1953): 4,
                               ('a05', 'modbus', 2, 1, 'target', 1000): 4,
                               ('a05', 'modbus', 2, 2, 'target', 2000): 4,
                               ('a05', 'modbus', 2, 3, 'no_target', None): 4,
                               ('a05', 'modbus', 2, 4, 'target', 3562): 4,
                               ('hps167s', 'modbus', 7, 1, 'target', 2083): 4})
        self.assertEqual(done.err, '')

    def test_each_request_leaves_at_the_rate_of_its_sensor(self):
        """Both have the factory's address, which is no conflict at two rates."""
        rates = collections.defaultdict(set)
        device, reader = self.beside('read a16:1 hps167s:1 --count 3 --format json')
        for _ in range(6):
            asked = device.read(8)
            rates[asked].add(device.baud())
            device.write(SAYS_754 if asked == ASK_A16 else SAYS_2083)
        done = self.ends(reader, 0)
        self.assertEqual(rates, {ASK_A16: {termios.B9600}, ASK_HPS: {termios.B19200}})
        self.assertEqual(sorted((one['model'], one['distance_mm']) for one in done.json),
                         [('a16', 754)] * 3 + [('hps167s', 2083)] * 3)

    def test_a_late_response_explains_the_failure_of_its_unit_alone(self):
        """Address 2 answers when its time is over, while address 3, where no unit is, is being asked."""
        device, reader = self.beside('read a16:2 a16:3 --timeout 400 --count 2')
        for _ in range(4):
            if device.read(8)[0] == 2:
                reader.expect('a16:2: attempt', 'err')
                device.write(e2e.registers(2, 754))
        err = reader.finish().err
        self.assertRegex(err, 'a16:2: attempt 2: .*: the response arrived after the time-out')
        self.assertRegex(err, 'a16:3: attempt 2: no response from a16:3 at [^:]*: (?!the response arrived)')
        self.assertNotIn('address 2 responds', err)


class Example(e2e.Case):
    def run_example(self, *arguments):
        return self.start([os.path.join(BUILD, 'examples', 'example_bus'), *arguments]).finish()

    def test_it_reads_three_sensors_while_one_comes_and_goes(self):
        done = self.run_example()
        self.assertEqual((done.code, done.err), (0, ''))
        before, between, after = re.split('-- .*\n', done.out)
        for part, has_a05 in ((before, True), (between, False), (after, True)):
            got = set(re.findall(r' s  (\S+) +probe (\d)  +(\d+ mm|no target)', part))
            expected = {('A16', '1', '1953 mm'), ('HPS-167S', '1', '2083 mm')}
            if has_a05:
                expected |= {('A05', '1', '1000 mm'), ('A05', '2', '2000 mm'), ('A05', '3', 'no target'),
                             ('A05', '4', '3562 mm')}
            self.assertEqual(got, expected)
        # A third of 3 s, 18.5 ms from one request to the next.
        self.assertGreaterEqual(before.count('HPS-167S probe'), 45)
        # 600 ms of time-out, once more until its late response can no longer come; left alone after the third,
        # for 0.6 s
        failures = re.search(r'A05 +responses \d+, failures (\d+), time-outs in a row (\d+), left alone for '
                             r'([\d.]+) s', between)
        self.assertEqual(failures[1], failures[2])
        self.assertGreaterEqual(int(failures[1]), 3)
        self.assertRegex(after, r'A05 +responses \d+, failures \d+, time-outs in a row 0, left alone for 0\.0 s')
        self.assertRegex(after, r'A16 +responses \d+, failures 0, ')
        self.assertRegex(after, r'HPS-167S responses \d+, failures 0, ')

    def test_it_reads_a_port_too(self):
        done = self.run_example(self.sim(SEEN), 2)
        self.assertEqual((done.code, done.err), (0, ''))
        for words in ('A16      probe 1   1953 mm', 'A05      probe 4   3562 mm',
                      'HPS-167S probe 1   2083 mm'):
            self.assertIn(words, done.out)

    def test_a_port_that_is_not_there_is_said(self):
        self.ends(self.run_example('/nowhere'), 1, '/nowhere', out='')


if __name__ == '__main__':
    e2e.main()
