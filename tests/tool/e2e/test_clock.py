#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""time_us across the wrap of the library's 32-bit clock, which is brought near by a preloaded clock."""
import datetime

import e2e

WRAP = 1 << 32


class Clock(e2e.Case):
    def read(self, sensor, mode, count, **shim):
        """The readings, and (time_us, utc in s) from each to the next."""
        sim = self.sim(f'{sensor}::{mode} --distance 754')
        objects = self.read_json(f'{sensor} --mode {mode} --port {sim} --count {count}',
                                 env=self.preload('clock_shim.c', **shim))
        self.assertEqual(len(objects), count)
        at = [datetime.datetime.fromisoformat(one['utc'].replace('Z', '+00:00')).timestamp()
              for one in objects]
        return objects, [(objects[i + 1]['time_us'] - objects[i]['time_us'], at[i + 1] - at[i])
                         for i in range(count - 1)]

    @e2e.each(frames_on_both_sides_of_the_wrap=('a16', 'auto', 15, '700000'),
              responses_on_both_sides_of_the_wrap=('hps167s', 'modbus', 60, '300000'))
    def steady(self, sensor, mode, count, wrap_in_us):
        objects, passed = self.read(sensor, mode, count, WRAP_IN_US=wrap_in_us)
        self.assertLess(objects[0]['time_us'], 10e6)
        self.assertGreater(objects[-1]['time_us'], 1e6)
        for time_us, seconds in passed:
            self.assertGreaterEqual(time_us, 0)  # what a busy machine reads at once has one time
            self.assertAlmostEqual(time_us / 1e6, seconds, delta=2)

    def test_time_goes_on_above_32_bits(self):
        objects, passed = self.read('a16', 'auto', 15, WRAP_IN_US='3000000', JUMP_IN_US='700000')
        jump, = (time_us for time_us, _ in passed if time_us > WRAP)
        self.assertAlmostEqual(jump / 1e6, 3 * WRAP / 1e6, delta=10)
        self.assertGreater(objects[-1]['time_us'], 3 * WRAP)
        for _, seconds in passed:  # while the calendar knows nothing of it
            self.assertLess(seconds, e2e.PATIENCE)


if __name__ == '__main__':
    e2e.main()
