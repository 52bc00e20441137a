#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against a server that responds wrongly, byte for byte, which no Modbus library does. No wrong response
becomes a reading, the next right one does, the run ends in time, and the message names the cause. (Echoes, pieces, late
responses and noise: unit/test_line*.c.) It needs real time: CTest runs one such file at a time."""
import re

import interop
from interop import e2e

# What each is asked (address and count), what it says (HPS-167S #5), what is read from that.
REQUEST = {'a16': (1, 0, 0, 1), 'a05': (1, 6, 0, 4), 'hps167s': (0, 8, 0, 4)}
SAID = {'a16': (754,), 'a05': (1000, 2000, 1953, 3562), 'hps167s': (0x0823, 0xDCB2, 0x0701, 0)}
READ = {'a16': ['754'], 'a05': ['1000', '2000', '1953', '3562'], 'hps167s': ['2083']}
TIMEOUT = 1  # seconds; a script on a busy machine responses well within

UNFIT = 'the response does not fit the request. Check that the sensor is '
DAMAGED = 'damaged response from '
NO_RESPONSE = 'no response from '
SILENT = NO_RESPONSE + '.*: '
OTHERS = SILENT + 'the line works, but address 2 responds. Try --address 2'
NOBODYS = SILENT + 'the line works, but address 255 responds, which no '
OTHER_MASTER = 'another master asked this sensor at the same time'
NO_FRAME = SILENT + 'bytes were received, but no Modbus frame'
BEGINNING = 'no response from .*: the first bytes of the response are missing or damaged'
NOTHING = SILENT + 'no byte was received'


def resized(response, size, data):
    """Another byte count and other data, under a right CRC."""
    return e2e.adu(*response[:2], size, *data)


class Raw(e2e.Case):
    def request(self):
        return e2e.adu(1, 3, *REQUEST[self.sensor])

    def right(self):
        return e2e.registers(1, *SAID[self.sensor])

    @e2e.each(
        the_input_registers_of_function_04=(lambda right: e2e.adu(1, 4, *right[2:-2]), NO_FRAME),
        another_function_with_a_right_crc=(lambda right: e2e.adu(1, 6, 1, 0, 8, 0xAE), OTHER_MASTER),
        another_units_response=(lambda right: e2e.adu(2, *right[1:-2]), OTHERS),
        an_exception_to_this_request=(lambda right: e2e.adu(1, 0x83, 3),
                                      r'refused the request: exception 03 \(illegal data value\)'),
        an_exception=(lambda right: e2e.adu(1, 0x83, 4), r'refused the request: exception 04 \(server device failure\)'),
        a_wrong_crc=(lambda right: right[:-1] + bytes((right[-1] ^ 1,)), DAMAGED),
        what_follows_a_truncated_response_is_not_joined_to_it=(lambda right: right[:5], DAMAGED),
        silence=(lambda right: b'', NOTHING))
    def wrong(self, make, words):
        """The wrong response, then the right one."""
        done = self.play(f'read {self.sensor} --mode modbus --timeout 1000 --format csv --stats', self.request(),
                         [make(self.right())], [self.right()])
        # each attempt takes its time-out of 1 s, and as long again for the quarantine
        self.assertLess(done.elapsed, e2e.PATIENCE + 4)
        self.assertEqual(done.mm, READ[self.sensor], done)
        self.ends(done, 1, re.compile(f'attempt 1: .*{words}'),
                  f'attempts 2, failed 1, readings {len(READ[self.sensor])}\n')
        self.assertEqual(done.err.count('attempt '), 1, done.err)

    def test_the_acknowledgement_of_a_write(self):
        """It equals the write. While a read is pending, a write of another master looks the same."""
        self.wrong(lambda right: e2e.adu(1, 6, *REQUEST[self.sensor]), OTHER_MASTER)

    def test_fewer_registers_than_were_asked_for(self):
        """Of one register there are no fewer: none at all is no frame."""
        words = NO_FRAME if self.sensor == 'a16' else UNFIT
        self.wrong(lambda right: resized(right, right[2] - 2, right[3:-4]), words)

    def test_a_wrong_count_with_a_right_crc(self):
        for count in (2, 3, 5):
            self.wrong(lambda right: e2e.registers(1, *[2222] * count), UNFIT)


class OneDistance:
    def test_figures_that_the_sensor_cannot_mean(self):
        self.wrong(lambda right: e2e.registers(1, 40000, *SAID[self.sensor][1:]), self.refused)


class A16(OneDistance, Raw):
    sensor = 'a16'
    refused = '40000 is no distance from 1 to 16350 mm'


class A05(Raw):
    sensor = 'a05'


class Hps167s(OneDistance, Raw):
    sensor = 'hps167s'
    refused = 'the values cannot be a distance: 40000'

    @e2e.each(
        an_odd_byte_count=(lambda right: resized(right, right[2] + 1, (*right[3:-2], 0x55)), NO_FRAME),
        # The frame is not whole when its data are over.
        a_byte_count_that_is_too_large_for_what_comes=(lambda right: resized(right, right[2] + 2,
                                                                             right[3:-2]), DAMAGED),
        the_acknowledgement_of_a_write_of_many=(lambda right: e2e.adu(1, 16, *REQUEST['hps167s']), UNFIT),
        another_units_exception=(lambda right: e2e.adu(2, 0x83, 2), OTHERS),
        an_exception_to_another_function=(lambda right: e2e.adu(1, 0x86, 2), UNFIT),
        an_exception_to_a_function_that_was_never_used=(lambda right: e2e.adu(1, 0x84, 2), NO_FRAME),
        a_crc_in_the_other_order=(lambda right: right[:-2] + right[:-3:-1], DAMAGED),
        a_response_without_its_end=(lambda right: right[:-1], DAMAGED),
        a_response_without_its_beginning=(lambda right: right[1:], BEGINNING),
        # Unit 0 asks, and never answers.
        a_broadcast_response=(lambda right: e2e.registers(0, *SAID['hps167s']), NO_FRAME),
        a_response_to_everybody=(lambda right: e2e.registers(255, *SAID['hps167s']), NOBODYS))
    def only_here(self, make, words):
        self.wrong(make, words)


del Raw  # which has no sensor

if __name__ == '__main__':
    interop.main(at_once=8)
