#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Late responses: one of the right shape that comes in the next request of the same unit is never shown as that
request's reading. It needs real time: CTest runs one such file at a time."""
import re

import e2e


class Late(e2e.Case):
    def begin(self, count, timeout, options=''):
        """What an A16 that says so many mm is told to say; and the reader."""
        device, reader = self.beside(f'read a16 --mode modbus --timeout {timeout} --count {count} --format '
                                     'csv --stats', options)
        return device, lambda mm: device.write(e2e.registers(1, mm)), reader

    def test_a_response_during_the_next_attempt_is_not_its_reading(self):
        device, say, reader = self.begin(2, 1000)
        device.asked(e2e.ASK_A16)
        reader.expect('attempt 1: no response from a16:1 ', 'err')
        say(1111)  # to the first request; the second attempt has begun
        device.asked(e2e.ASK_A16)  # only when the late one has come
        say(2222)
        done = self.ends(reader, 1, 'attempts 2, failed 1, readings 1\n',
                         re.compile(r'line: responses 1, .*no_responses 1, .*late_responses 1, '))
        self.assertEqual(done.mm, ['2222'])

    def test_the_next_request_waits_for_the_late_response_at_least_another_time_out(self):
        device, say, reader = self.begin(2, 1000)
        device.asked(e2e.ASK_A16)
        reader.expect('attempt 1: no response', 'err')
        self.assertTrue(device.is_silent(0.7))
        say(1111)
        device.asked(e2e.ASK_A16)
        say(2222)
        self.assertEqual(reader.finish().mm, ['2222'])

    def test_each_response_one_request_too_late(self):
        device, say, reader = self.begin(5, 500)
        for number in range(1, 6):
            device.asked(e2e.ASK_A16)
            reader.expect(f'attempt {number}: no response', 'err')
            if number != 5:
                say(1000 + number)
        done = self.ends(reader, 1, 'late_responses 4')
        self.assertEqual(done.mm, [])
        self.assertEqual(re.findall(r'attempt (\d): .*: the response arrived after the time-out',
                                    done.err),
                         ['2', '3', '4', '5'])

    def test_a_late_response_serves_a_retry_of_its_own_request(self):
        device, say, reader = self.begin(1, 500, '--retries 1')
        device.asked(e2e.ASK_A16)
        self.assertTrue(device.is_silent(0.6))  # the time-out has passed, the retry waits
        say(1111)
        self.assertEqual(self.ends(reader, 0, 'late_responses 1').mm, ['1111'])

    def test_a_unit_that_never_answers_is_asked_again(self):
        device, _, reader = self.begin(3, 150)
        for number in range(1, 4):
            device.asked(e2e.ASK_A16)
            reader.expect(f'attempt {number}: no response', 'err')
        self.ends(reader, 1)

    def test_an_unasked_response_in_a_pause_is_not_the_next_reading(self):
        device, say, reader = self.begin(2, 1000, '--interval 1500')
        device.asked(e2e.ASK_A16)
        say(1111)
        reader.expect(',1111,')
        say(3333)
        device.asked(e2e.ASK_A16)
        say(2222)
        self.assertEqual(self.ends(reader, 0).mm, ['1111', '2222'])


if __name__ == '__main__':
    e2e.main()
