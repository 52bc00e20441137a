#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The first programs of examples/ for Linux, each with the simulated sensor that it is for."""
import collections
import os
import re

import e2e

SERIAL = ('a16_auto', 'a16_controlled', 'a16_modbus', 'a05_auto', 'a05_dyp', 'a05_modbus', 'hps167s', 'hps167s_auto')
PROGRAMS = os.path.join(os.environ.get('FATHOM_BUILD', ''), 'examples')


class Complete(e2e.Case):
    """examples/linux/first.c"""

    def gate(self, *arguments):
        return self.start([os.path.join(PROGRAMS, 'example_first'), *arguments])

    @e2e.each(a_distance=('--distance 2083', '2083 mm'), nothing_in_range=('--distance no-target', 'nothing in range'),
              a_device_that_has_failed=('--distance fault', 'no distance'),
              a_damaged_response=('--fault flip-byte', r'no reading \(CHECKSUM\)\. [A-Z].*\.'))
    def reading(self, sensor, words):
        gate = self.gate(self.sim('hps167s', sensor))
        gate.expect(f'^{words}$')
        gate.expect(f'^{words}$')

    def test_after_a_silence_it_goes_on(self):
        gate = self.gate(self.sim('hps167s --distance 2083 --fault silence=1@2'))
        gate.expect('^2083 mm$')
        gate.expect(r'^no reading \(NO_RESPONSE\)\. [A-Z].*\.$')
        gate.expect('^2083 mm$')

    def test_without_a_path_it_opens_the_first_usb_adapter(self):
        if os.path.exists('/dev/ttyUSB0'):
            self.skipTest('this machine has an adapter')
        self.ends(self.gate(), 1, '/dev/ttyUSB0', out='')


class Three(e2e.Case):
    """examples/linux/three.c"""
    SEEN = 'a16:2:modbus,distance=754 a05:1:modbus,distance=1000,2000,no-target,3562 hps167s:5,distance=2083'
    LINES = {'A16: probe 1: 754 mm', 'A05: probe 1: 1000 mm', 'A05: probe 2: 2000 mm',
             'A05: probe 3: nothing in range', 'A05: probe 4: 3562 mm', 'HPS-167S: probe 1: 2083 mm'}

    def three(self, *arguments):
        return self.start([os.path.join(PROGRAMS, 'example_three'), *arguments])

    def test_each_sensor_is_read_again_and_again_at_its_own_settings(self):
        three = self.three(self.sim(self.SEEN))
        count = collections.Counter()
        while len(count) < len(self.LINES) or min(count.values()) < 2:
            count[three.expect('^(.*)$')[1]] += 1
            self.assertLess(sum(count.values()), 1000, count)
        self.assertEqual(set(count), self.LINES)

    def test_a_sensor_that_is_missing_is_named_and_the_others_are_read(self):
        three = self.three(self.sim('a16:2:modbus,distance=754 hps167s:5,distance=2083'))
        for _ in range(2):
            three.expect(r'^A05: no reading \(NO_RESPONSE\)\. [A-Z].*\.$')
            three.expect('^A16: probe 1: 754 mm$')
            three.expect('^HPS-167S: probe 1: 2083 mm$')
        self.assertEqual([line for line in three.lines() if not line.startswith('A05: no reading (NO_RESPONSE)') and
                          line not in self.LINES], [])

class Ends(e2e.Case):
    """examples/linux/first.c and three.c"""

    @e2e.each(the_first=('example_first', 'hps167s --distance 2083', '2083 mm'),
              the_three=('example_three', Three.SEEN, 'A16: probe 1: 754 mm'))
    def ends_with_the_reason(self, name, sensors, line):
        program, sim = os.path.join(PROGRAMS, name), self.sim(sensors)
        with open('/dev/full', 'w', encoding='utf-8') as full:
            self.ends(self.start([program, sim], stdout=full), 1)
        self.ends(self.start([program, '/nowhere']), 1, '/nowhere', out='')
        running = self.start([program, sim])
        running.expect(f'^{line}$')
        sim.end()
        running.expect(r'no reading \(PORT\)\. [A-Z].*\.$')
        self.ends(running, 1, re.compile(f'^{re.escape(str(sim))}: \\S.*\n$'))


class Modes(e2e.Case):
    """examples/first/MODE.c: those whose sensor has a serial port"""

    def program(self, mode, *arguments):
        return self.start([os.path.join(PROGRAMS, 'first', 'example_first_' + mode), *arguments])

    @e2e.each(a16_auto=('a16_auto', 'a16 --distance 1234', ['probe 1: 1234 mm']),
              a16_controlled=('a16_controlled', 'a16::controlled --distance 1234', ['probe 1: 1234 mm']),
              a16_modbus=('a16_modbus', 'a16::modbus --distance 1234', ['probe 1: 1234 mm']),
              a05_auto=('a05_auto', 'a05 --distance 1000,2000,1953,no-target',
                        ['probe 1: 1000 mm', 'probe 2: 2000 mm', 'probe 3: 1953 mm', 'probe 4: nothing in range']),
              a05_dyp=('a05_dyp', 'a05::dyp --distance 1000,2000,1953,no-target',
                       ['probe 1: 1000 mm', 'probe 2: 2000 mm', 'probe 3: 1953 mm', 'probe 4: nothing in range']),
              a05_modbus=('a05_modbus', 'a05::modbus --distance 1000,2000,1953,no-target',
                          ['probe 1: 1000 mm', 'probe 2: 2000 mm', 'probe 3: 1953 mm', 'probe 4: nothing in range']),
              hps167s=('hps167s', 'hps167s --distance 2083', ['probe 1: 2083 mm']),
              hps167s_auto=('hps167s_auto', 'hps167s::auto --distance 2083', ['probe 1: 2083 mm']))
    def reading(self, mode, sensor, lines):
        program = self.program(mode, self.sim(sensor))
        for line in 2 * lines:
            program.expect(f'^{line}$')
        sensors = program.lines()
        self.assertEqual([line for line in sensors if line.startswith('probe') and line not in lines], [])

    @e2e.each(**{'silent_' + mode: mode for mode in SERIAL})
    def silent(self, mode):
        device = self.device()
        self.program(mode, device.port).expect(r'^no reading \((NO_RESPONSE|STALE)\)\. [A-Z].*\.$')

    @e2e.each(**{'no_port_' + mode: mode for mode in SERIAL})
    def no_port(self, mode):
        self.ends(self.program(mode, '/nowhere'), 1, '/nowhere', out='')

    @e2e.each(no_pin_of_a16_switch=('a16_switch', ['/nowhere', '17'], '/nowhere'),
              no_pin_of_a16_pwm=('a16_pwm', ['/nowhere', '17', '27'], '/nowhere'),
              no_pin_of_a05_relay=('a05_relay', ['/nowhere', '17'], '/nowhere'),
              no_arguments=('a05_relay', [], 'a05_relay CHIP LINE\n'),
              too_few_arguments=('a16_pwm', ['/nowhere', '17'], 'a16_pwm CHIP LINE LINE\n'))
    def no_pin(self, mode, arguments, words):
        self.ends(self.program(mode, *arguments), 1, words, out='')


if __name__ == '__main__':
    e2e.main()
