#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Late answers: one of the right shape that comes in the next request of the same unit is never shown as that
request's reading."""
import re

import e2e

REQUEST = e2e.adu(1, 3, 1, 0, 0, 1)


class Late(e2e.Case):
    def begin(self, count, timeout, *arguments):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', timeout, '--count',
                             count, '--format', 'csv', *arguments)
        return device, reader

    def shown(self, done):
        return [int(row.split(',')[9]) for row in done.out.splitlines()[1:]]

    def test_an_answer_during_the_next_attempt_is_not_its_reading(self):
        device, reader = self.begin(2, 1000)
        self.assertEqual(device.read(8), REQUEST)
        reader.expect('attempt 1: no answer from address 1', 'err')
        device.write(e2e.registers(1, 1111))  # to the first request; the second attempt has begun
        self.assertEqual(device.read(8), REQUEST)  # asked only when the late one has come
        device.write(e2e.registers(1, 2222))
        done = reader.finish()
        self.assertEqual((done.code, self.shown(done)), (1, [2222]))
        self.assertIn('attempts 2, failed 1, readings 1\n', done.err)
        self.assertRegex(done.err, r'line: answers 1, .*requests without an answer 1, late answers 1\n')

    def test_the_next_request_waits_for_the_late_answer_at_least_another_time_out(self):
        device, reader = self.begin(2, 1000)
        device.read(8)
        reader.expect('attempt 1: no answer', 'err')
        self.assertTrue(device.is_silent(0.7))
        device.write(e2e.registers(1, 1111))
        device.read(8)
        device.write(e2e.registers(1, 2222))
        self.assertEqual(self.shown(reader.finish()), [2222])

    def test_each_answer_one_request_too_late(self):
        device, reader = self.begin(5, 400)
        for number in range(1, 6):
            self.assertEqual(device.read(8), REQUEST)
            reader.expect(f'attempt {number}: no answer', 'err')
            if number != 5:
                device.write(e2e.registers(1, 1000 + number))
        done = reader.finish()
        self.assertEqual((done.code, self.shown(done)), (1, []))
        self.assertIn('late answers 4', done.err)
        self.assertEqual(re.findall(r'attempt (\d): no answer from address 1: it answers, but too late', done.err),
                         ['2', '3', '4', '5'])

    def test_a_late_answer_serves_a_retry_of_its_own_request(self):
        device, reader = self.begin(1, 400, '--retries', '1')
        self.assertEqual(device.read(8), REQUEST)
        self.assertTrue(device.is_silent(0.5))  # the time-out has passed, the retry waits
        device.write(e2e.registers(1, 1111))
        done = reader.finish()
        self.assertEqual((done.code, self.shown(done)), (0, [1111]))
        self.assertIn('late answers 1', done.err)

    def test_a_unit_that_never_answers_is_asked_again(self):
        device, reader = self.begin(3, 150)
        for number in range(1, 4):
            self.assertEqual(device.read(8), REQUEST)
            reader.expect(f'attempt {number}: no answer', 'err')
        self.assertEqual(reader.finish().code, 1)

    def test_an_unasked_answer_in_a_pause_is_not_the_next_reading(self):
        device, reader = self.begin(2, 1000, '--interval', '1500')
        device.read(8)
        device.write(e2e.registers(1, 1111))
        reader.expect(',1111,')
        device.write(e2e.registers(1, 3333))
        self.assertEqual(device.read(8), REQUEST)
        device.write(e2e.registers(1, 2222))
        done = reader.finish()
        self.assertEqual((done.code, self.shown(done)), (0, [1111, 2222]))


if __name__ == '__main__':
    e2e.main()
