#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read a16 --mode controlled: an A16 that measures once for each break (A16 3). Through a pseudo terminal a byte 0
stands for the break."""
import json
import threading

import e2e

A16_EXAMPLE = bytes.fromhex('FF 07 A1 A7')  # 1953 mm, A16 3(5)


class Controlled(e2e.Case):
    def read(self, port, count, *arguments):
        """The readings, and how long it took. On a busy machine the simulated answer may come later than 130 ms after
        the trigger, and is none then."""
        done = self.run_fathom('read', 'a16', '--mode', 'controlled', '--port', port, '--count', count, '--format', 'json',
                               *arguments)
        failed = done.err.count('no answer to the trigger')
        readings = [json.loads(line) for line in done.out.splitlines()]
        self.assertEqual(len(readings) + failed, count, done.err)
        self.assertEqual(done.code, 1 if failed else 0)
        self.assertGreater(len(readings), count // 2, done.err)
        return readings, done.elapsed

    def answering(self, answer, times):
        """A device that answers so many triggers, and nothing else."""
        device = self.device()

        def serve():
            for _ in range(times):
                assert device.read(1) == b'\0'
                device.write(answer)
        thread = threading.Thread(target=serve)
        thread.start()
        self.addCleanup(thread.join)
        return device

    def test_each_trigger_brings_one_reading(self):
        sim = self.sim('a16:1:controlled', '--distance', '1953')
        readings, elapsed = self.read(sim.port, 8)
        for one in readings:
            self.assertEqual((one['status'], one['distance_mm'], one['address']), ('target', 1953, None))
        self.assertGreater(elapsed, 7 * 0.121)  # from trigger to trigger, "must be greater than 120ms" (A16 3(2))

    def test_nothing_in_range_is_a_reading(self):
        sim = self.sim('a16:1:controlled', '--distance', 'no-target')
        readings, _ = self.read(sim.port, 5)
        self.assertEqual({one['status'] for one in readings}, {'no_target'})

    def test_without_an_answer_it_says_what_to_check(self):
        device = self.device()
        done = self.run_fathom('read', 'a16', '--mode', 'controlled', '--port', device.path, '--count', 2)
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertEqual(done.err.count('no answer to the trigger; check the supply'), 2, done.err)
        self.assertEqual(device.read(2), b'\0\0')

    def test_an_answer_that_comes_at_once_is_none(self):
        # The example of the datasheet, but not 90 to 110 ms after the trigger.
        device = self.answering(A16_EXAMPLE, 2)
        done = self.run_fathom('read', 'a16', '--mode', 'controlled', '--port', device.path, '--count', 2)
        self.assertEqual((done.code, done.out), (1, ''))

    def test_an_interval_is_kept(self):
        sim = self.sim('a16:1:controlled', '--distance', '1953')
        _, elapsed = self.read(sim.port, 4, '--interval', 400)
        self.assertGreater(elapsed, 3 * 0.4)

    def test_it_has_its_line_alone(self):
        done = self.run_fathom('read', 'a16:1:controlled', 'hps167s:7', '--port', self.path('nowhere'))
        self.assertEqual(done.code, 2)

    def test_it_needs_a_serial_port(self):
        done = self.run_fathom('read', 'a16:1:controlled', '--port', 'tcp:127.0.0.1:1')
        self.assertEqual(done.code, 2)
        self.assertIn('needs a serial port', done.err)


if __name__ == '__main__':
    e2e.main()
