#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""time_us across the wrap of the library's 32-bit clock, which is brought near by a preloaded clock."""
import datetime
import os
import subprocess

import e2e

WRAP = 1 << 32


class Clock(e2e.Case):
    def read(self, sensor, mode, count, **shim):
        sim = self.sim(f'{sensor}::{mode}', '--distance', '754')
        environment = {**self.preload('clock_shim.c'), **shim}
        objects = self.read_json(sensor, '--mode', mode, '--port', sim.port, '--count', count, env=environment)
        self.assertEqual(len(objects), int(count))
        for one in objects:
            one['at'] = datetime.datetime.fromisoformat(one['utc'].replace('Z', '+00:00')).timestamp()
        return objects

    def pairs(self, objects):
        """(time_us, utc in s) from each reading to the next."""
        return [(b['time_us'] - a['time_us'], b['at'] - a['at']) for a, b in zip(objects, objects[1:])]

    def check_steady(self, objects):
        self.assertLess(objects[0]['time_us'], 10e6)
        for passed_us, passed in self.pairs(objects):
            self.assertGreater(passed_us, 0)
            self.assertAlmostEqual(passed_us / 1e6, passed, delta=0.2)

    def test_frames_on_both_sides_of_the_wrap(self):
        self.check_steady(self.read('a16', 'auto', '15', WRAP_IN_US='700000'))

    def test_answers_on_both_sides_of_the_wrap(self):
        self.check_steady(self.read('hps167s', 'modbus', '60', WRAP_IN_US='300000'))

    def test_a_time_before_the_wrap_told_after_it(self):
        program = self.path('extend_check')
        subprocess.run(['cc', '-std=c99', *(f'-I{e2e.ROOT}/{folder}' for folder in
                                            ('include', 'port', 'port/posix', 'examples/fathom')), '-o', program,
                        os.path.join(e2e.HERE, 'extend_check.c'), f'{e2e.ROOT}/examples/fathom/output.c'], check=True)
        cases = [(5 * WRAP + 10, 10, 5 * WRAP + 10), (5 * WRAP + 10, 9, 5 * WRAP + 9),
                 (5 * WRAP + 10, WRAP - 1, 5 * WRAP - 1), (5 * WRAP, WRAP - 1, 5 * WRAP - 1),
                 (5 * WRAP, 0, 5 * WRAP), (5 * WRAP - 1, 0, 4 * WRAP), (WRAP + 5, 11, 11)]
        told = subprocess.run([program, *(str(number) for case in cases for number in case[:2])],
                              stdout=subprocess.PIPE, text=True, check=True).stdout
        self.assertEqual([int(line) for line in told.split()], [case[2] for case in cases])

    def test_time_goes_on_above_32_bits(self):
        objects = self.read('a16', 'auto', '15', WRAP_IN_US='3000000', JUMP_IN_US='700000')
        pairs = self.pairs(objects)
        jumps = [passed_us for passed_us, _ in pairs if passed_us > WRAP]
        self.assertEqual(len(jumps), 1, pairs)
        self.assertAlmostEqual(jumps[0] / 1e6, 3 * WRAP / 1e6, delta=1)
        self.assertGreater(objects[-1]['time_us'], 3 * WRAP)
        for _, passed in pairs:  # while the calendar knows nothing of it
            self.assertLess(passed, 5)


if __name__ == '__main__':
    e2e.main()
