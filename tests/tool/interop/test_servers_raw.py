#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against a server that answers wrongly: byte for byte by hand, which no Modbus library does. No
wrong response becomes a reading, the next right one does, the run ends in its time, and exit status, message
and counters say what it was. It needs real time: CTest runs one such file at a time."""
import random
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
NOTHING = SILENT + 'no byte was received'


def resized(response, size, data):
    """Another byte count and other data, under a right CRC."""
    return e2e.adu(*response[:2], size, *data)


def flipped(data, at, bit=1):
    return data[:at] + bytes((data[at] ^ bit,)) + data[at + 1:]


def noise():
    """Garbage of every kind, of which none is a response by chance: no part of it has a right CRC."""
    source = random.Random(5)
    blocks = [source.randbytes(source.randrange(1, 40)) for _ in range(6)]
    for block in blocks:
        for at in range(len(block)):
            for end in range(at + 5, len(block) + 1):
                assert e2e.crc16(block[at:end - 2]) != block[end - 2:end]
    return blocks


class Raw(e2e.Case):
    def plays(self, scripts, good, code, *words, options='', timeout=TIMEOUT):
        """So many of the scripts give a reading."""
        line = f'read {self.sensor} --mode modbus --timeout {timeout * 1000:.0f} --format csv --stats {options}'
        done = self.play(line, self.request(), *scripts)
        # each attempt takes its time-out, and as long again for the quarantine
        self.assertLess(done.elapsed, e2e.PATIENCE + 2 * len(scripts) * timeout)
        self.assertEqual(done.mm, READ[self.sensor] * good, done)
        bad = len(scripts) - good
        counted = f'attempts {len(scripts)}, failed {bad}, readings {good * len(READ[self.sensor])}\n'
        self.ends(done, code, counted, *words)
        self.assertEqual(done.err.count('attempt '), bad, done.err)
        return done

    def request(self):
        return e2e.adu(1, 3, *REQUEST[self.sensor])

    def right(self):
        return e2e.registers(1, *SAID[self.sensor])

    @e2e.each(
        garbage_before_the_response=lambda right: [b'\x00\x55\xFE\x80' + right],
        garbage_that_looks_like_the_beginning_of_a_response=lambda right: [b'\x01\x03' + right],
        a_response_of_another_unit_before_the_own=lambda right: [e2e.registers(2, 1, 2, 3, 4) + right],
        trailing_bytes=lambda right: [right + b'\x00\xFE\x55'],
        # The second copy comes before the next request and belongs to none.
        a_response_twice=lambda right: [right * 2])
    def good(self, make):
        done = self.plays([make(self.right()), make(self.right()), [self.right()]], 3, 0)
        self.assertIn('responses 3', done.err)

    @e2e.each(
        more_registers_than_were_asked_for=(lambda right: resized(right, right[2] + 2, (*right[3:-2], 2, 1)),
                                            UNFIT),
        the_input_registers_of_function_04=(lambda right: e2e.adu(1, 4, *right[2:-2]), NO_FRAME),
        another_function_with_a_right_crc=(lambda right: e2e.adu(1, 6, 1, 0, 8, 0xAE), OTHER_MASTER),
        another_units_response=(lambda right: e2e.adu(2, *right[1:-2]), OTHERS),
        an_exception_to_this_request=(lambda right: e2e.adu(1, 0x83, 3),
                                      r'refused the request: exception 03 \(illegal data value\)'),
        an_exception=(lambda right: e2e.adu(1, 0x83, 4), r'refused the request: exception 04 \(server device failure\)'),
        a_wrong_crc=(lambda right: flipped(right, len(right) - 1), DAMAGED),
        what_follows_a_truncated_response_is_not_joined_to_it=(lambda right: right[:5], DAMAGED),
        silence=(lambda right: b'', NOTHING))
    def wrong(self, make, words):
        self.plays([[make(self.right())], [self.right()]], 1, 1, re.compile(f'attempt 1: .*{words}'))

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

    @e2e.each(a_response_byte_by_byte=range(1, 99),
              **{f'the_response_in_two_writes_with_a_pause_{cut}': [cut] for cut in (1, 3, 5)})
    def in_pieces(self, cuts):
        """A pause of 25 ms ends a frame. A busy machine may make as much of 10 ms, but not every time."""
        right = self.right()
        cuts = [0, *(cut for cut in cuts if cut < len(right)), len(right)]
        pieces = [right[begin:end] for begin, end in zip(cuts, cuts[1:])]
        pauses = [0.01] if len(pieces) == 2 else []
        done = self.play(f'read {self.sensor} --mode modbus --timeout 1000 --format csv', self.request(),
                         *[[pieces[0], *pauses, *pieces[1:]]] * 6)
        self.assertIn(done.mm, [READ[self.sensor] * good for good in range(1, 7)], done)
        return done

    def all_fail(self, *responses):
        """Each of these is no response, and told as that."""
        done = self.plays([[response] for response in responses], 0, 1, timeout=0.3)
        self.assertEqual(done.err.count(DAMAGED) + done.err.count(NO_RESPONSE), len(responses), done)

    def test_a_truncated_response_at_every_length(self):
        self.all_fail(*(self.right()[:length] for length in range(1, len(self.right()))))

    def test_a_flipped_bit_in_every_byte(self):
        self.all_fail(*(flipped(self.right(), at, 1 << 3 * at % 8) for at in range(len(self.right()))))

    def test_a_late_response_is_told_and_not_shown(self):
        """As late as two time-outs, the last moment in which it can be told from the next one's response."""
        late = e2e.registers(1, *[2222] * len(SAID[self.sensor]))
        self.plays([[1.5 * TIMEOUT, late], [self.right()]], 1, 1, 'late_responses 1')

    def test_the_echo_of_the_request_before_the_response(self):
        echo, right = self.request(), self.right()
        for options in ('', '--echo on'):
            self.plays([[echo, right], [echo, 0.05, right], [echo + right]], 3, 0,
                       'fathom: line: responses 3',
                       options=options)

    def test_an_echo_and_a_damaged_response(self):
        echo, right = self.request(), self.right()
        self.plays([[echo + flipped(right, 3, 2)], [echo + right]], 1, 1, f'attempt 1: {DAMAGED}')

    def test_the_request_itself_is_no_reading(self):
        self.plays([[self.request()]], 0, 1)

    def test_a_response_behind_another_units_is_read(self):
        self.plays([[e2e.registers(2, 1, 2, 3, 4), self.right()]], 1, 0, 'unsolicited_frames 1\n')

    def test_random_bytes(self):
        """A good response between."""
        scripts = [script for block in noise() for script in ([block], [0.03, self.right()])]
        self.plays(scripts, 6, 1, timeout=0.7)

    def test_an_unasked_frame_in_a_pause(self):
        request, right = self.request(), self.right()
        device, reader = self.beside(f'read {self.sensor} --mode modbus --count 2 --interval 500 '
                                     '--timeout 2000 --format csv')
        device.asked(request, right)
        reader.expect(f',{READ[self.sensor][-1]},')
        device.write(e2e.registers(1, *[2222] * len(SAID[self.sensor])))
        device.asked(request, right)
        self.assertEqual(self.ends(reader, 0).mm, READ[self.sensor] * 2)


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
        a_response_without_its_beginning=(lambda right: right[1:], NO_FRAME),
        # Unit 0 asks, and never answers.
        a_broadcast_response=(lambda right: e2e.registers(0, *SAID['hps167s']), NO_FRAME),
        a_response_to_everybody=(lambda right: e2e.registers(255, *SAID['hps167s']), NOBODYS))
    def only_here(self, make, words):
        self.wrong(make, words)

    def test_a_response_in_pieces_is_read(self):
        self.assertIn(',target,false,2083,2083,723.1744,1,0\n', self.in_pieces(range(1, 99)).out)


del Raw  # which has no sensor

if __name__ == '__main__':
    interop.main(at_once=8)
