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
                         re.compile(r'line: responses 1, .*no_responses 1, .*late_responses 1'))
        self.assertEqual(done.mm, ['2222'])

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


if __name__ == '__main__':
    e2e.main()
