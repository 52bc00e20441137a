#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read a16 --mode controlled: an A16 that measures once for each break (A16 3). Through a pseudo
terminal a byte 0 stands for the break. It needs real time: CTest runs one such file at a time."""
import itertools
import os
import re
import time

import e2e

SENSOR = 'a16 --mode controlled'


class Pin(e2e.Case):
    @e2e.each(an_a16_is_triggered_by_a_fall=('a16:pwm', '^1+0+1'), an_hc_sr04_by_a_rise=('hc-sr04', '^0+1+0'))
    def levels(self, sensor, levels):
        """The line is opened at its idle level: another first level would be a trigger."""
        os.mkfifo(self.path('events'))
        with open(self.path('level'), 'w', encoding='ascii') as file:
            file.write('0')
        names = {f'GPIO_{name.upper()}': self.path(name) for name in ('events', 'level', 'log')}
        self.ends(f'read {sensor}@gpiochip0,trigger=17,echo=27 --count 1', 1, 'no pulse was received',
                  env=self.preload('gpio_shim.c', **names))
        with open(self.path('log'), encoding='ascii') as file:
            self.assertRegex(file.read(), levels)


class Controlled(e2e.Case):
    def read(self, distance, count, options=''):
        """The readings, and how long it took. A response is one if it comes 80 to 130 ms after the trigger (A16 3(3)). On a
        busy machine the simulated one may come later, or end later; then the attempt fails."""
        sim = self.sim(f'a16:1:controlled --distance {distance}')
        for _ in range(5):  # and not every time
            done = self.run_fathom(f'read {SENSOR} --port {sim} --count {count} --format json {options}')
            failed = len(re.findall(r'attempt \d+: (?:no response from|damaged response) ', done.err))
            self.assertEqual(len(done.json) + failed, count, done)
            self.assertEqual(done.code, 1 if failed else 0)
            if len(done.json) > count // 2:
                return done.json, done.elapsed
        raise AssertionError(done)

    def test_each_trigger_brings_one_reading(self):
        readings, elapsed = self.read(1953, 8)
        for one in readings:
            self.assertEqual((one['status'], one['distance_mm'], one['address']), ('target', 1953, None))
        # From trigger to trigger, "must be greater than 120ms" (A16 3(2)).
        self.assertGreater(elapsed, 7 * 0.121)

    def test_nothing_in_range_is_a_reading(self):
        self.assertEqual({one['status'] for one in self.read('no-target', 5)[0]}, {'no_target'})

    def test_without_a_response_it_says_what_to_check(self):
        device, reader = self.beside(f'read {SENSOR} --count 2')
        self.ends(reader, 1, 'nothing followed the trigger. Check the supply', 'the same cause as before, 2 times', out='')
        self.assertEqual(device.read(2), b'\0\0')

    def test_a_response_that_comes_at_once_is_none(self):
        """The example of the datasheet (A16 3(5)), but not 90 to 110 ms after the trigger, unless this
        machine is that busy; and not every time."""
        response = [bytes.fromhex('FF 07 A1 A7')]
        for _ in range(5):
            done = self.play(f'read {SENSOR}', b'\0', response, response)
            if not done.out:
                break
        self.ends(done, 1, out='')

    def test_an_interval_is_kept(self):
        self.assertGreater(self.read(1953, 4, '--interval 400')[1], 3 * 0.4)


class Streaming(e2e.Case):
    """A module that sends without a trigger, read as one with a trigger. A trigger has one frame, and the frame for the
    trigger before may be late; so three frames between two triggers prove it."""
    NAMED = "frames are received without a trigger, so the module is the automatic form \\({}\\)[.] Try '{}'$"

    def is_named(self, sensor, form, name, period, values, more=''):
        """Its frames are sent until the message is there. From then on no frame is a reading."""
        device, reader = self.beside(f'read {sensor} --format csv')
        command = f'fathom read {name} --port {device}{more}'
        named = re.compile(self.NAMED.format(re.escape(form), re.escape(command)), re.M)
        value = itertools.cycle(values)
        end = time.monotonic() + e2e.PATIENCE
        while not reader.hear(lambda: named.search(reader.said['err'].decode()), period):
            self.assertLess(time.monotonic(), end, reader.said)
            device.write(e2e.frame(next(value)))
        readings = [line for line in reader.lines() if ',target,' in line]
        for _ in range(int(4 / period)):
            device.write(e2e.frame(next(value)))
            reader.has_ended(period)
        self.assertEqual([line for line in reader.lines() if ',target,' in line], readings)

    @e2e.each(
        each_100_ms=('a02yytw', 'U', 'a02yyuw', 0.1, (1953,)),
        each_300_ms_a_changing_value=('a02yytw', 'U', 'a02yyuw', 0.3, (1953, 1200, 800, 2400, 1100)),
        each_500_ms=('a02yytw', 'U', 'a02yyuw', 0.5, (1953, 1953, 1200)),
        each_100_ms_repeats=('aj-sr04m::controlled', 'R19 = 120k', 'aj-sr04m', 0.1, (800, 800, 800, 801)),
        each_100_ms_special_values=('a02yytw', 'U', 'a02yyuw', 0.1, (0xFFFD, 0xFFFF, 0)),
        of_the_datasheet=('a16::controlled', 'U', 'a16', 0.1, (1953, 1954)))
    def streams(self, sensor, form, name, period, values):
        self.is_named(sensor, form, name, period, values)

    def test_a_module_without_a_known_automatic_form_is_read_as_an_a16_at_its_rate(self):
        self.is_named('l081mtw', 'U', 'a16', 0.1, (1953,), ' --baud 115200')

    def test_a_simulated_module_is_named_and_its_command_reads_it(self):
        sim = self.sim('a02yyuw --distance 1953')
        reader = self.fathom(f'read a02yytw --format csv --port {sim}')
        command = reader.expect("frames are received without a trigger, .* Try 'fathom read (a02yyuw .*)'$", 'err')[1]
        reader.end()
        self.assertEqual(self.read_json(command, '--count 1')[0]['distance_mm'], 1953)

    def answers(self, sensor, count, late, noise):
        """A module with a trigger that responds once to each. A test that was delayed responds to the newest trigger."""
        device, reader = self.beside(f'read {sensor} --count {count} --format csv')
        number = 0
        while not reader.has_ended():
            if not e2e.is_ready(device.master, 0.01):
                continue
            os.read(device.master, 100)
            reader.has_ended(0.15 if number in late else 0.05)
            device.write(noise + e2e.frame(1000 + number))
            number += 1
        self.assertNotIn('without a trigger', reader.done.err)

    @e2e.each(
        responds_once=((), b''),
        responds_late_once=((3,), b''),
        responds_late_again_and_again=((2, 5, 6, 9), b''),
        responds_on_a_noisy_line=((), b'\x80\xF8'),
        responds_late_on_a_noisy_line=((3, 4), b'\x80\xF8'))
    def a_module_that(self, late, noise):
        self.answers('a02yytw', 15, late, noise)


if __name__ == '__main__':
    e2e.main()
