#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read a16 --mode controlled: an A16 that measures once for each break (A16 3). Through a pseudo terminal a byte 0
stands for the break."""
import threading

import e2e

A16_EXAMPLE = bytes.fromhex('FF 07 A1 A7')  # 1953 mm, A16 3(5)


class Controlled(e2e.Case):
    def read(self, port, *arguments, code=0):
        return self.read_json('a16', '--mode', 'controlled', '--port', port, *arguments, code=code)

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
        readings = self.read(sim.port, '--count', 3)
        self.assertEqual([(one['status'], one['distance_mm'], one['address']) for one in readings],
                         [('target', 1953, None)] * 3)
        times = [one['time_us'] for one in readings]
        for before, after in zip(times, times[1:]):
            self.assertGreater(after - before, 95000)  # 121 ms from trigger to trigger, the answer 90 to 110 ms later

    def test_nothing_in_range_is_a_reading(self):
        sim = self.sim('a16:1:controlled', '--distance', 'no-target')
        self.assertEqual(self.read(sim.port, '--count', 1)[0]['status'], 'no_target')

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
        times = [one['time_us'] for one in self.read(sim.port, '--count', 3, '--interval', 400)]
        for before, after in zip(times, times[1:]):
            self.assertGreater(after - before, 370000)

    def test_it_has_its_line_alone(self):
        done = self.run_fathom('read', 'a16:1:controlled', 'hps167s:7', '--port', self.path('nowhere'))
        self.assertEqual(done.code, 2)

    def test_it_needs_a_serial_port(self):
        done = self.run_fathom('read', 'a16:1:controlled', '--port', 'tcp:127.0.0.1:1')
        self.assertEqual(done.code, 2)
        self.assertIn('needs a serial port', done.err)


if __name__ == '__main__':
    e2e.main()
