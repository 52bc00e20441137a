#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against devices that misbehave: whatever comes, no wrong reading is printed, the run ends in its
time, and exit status, message and counters say what it was. The devices are scripted here, in raw bytes."""
import random
import re
import select
import time

import e2e

# sensor and options, the request, the answer to it, the field of csv that holds 1111, 1111's place in the answer
A16 = ('a16', '--mode', 'modbus'), e2e.adu(1, 3, 1, 0, 0, 1), lambda mm: e2e.registers(1, mm)
HPS = ('hps167s',), e2e.adu(1, 3, 0, 8, 0, 4), lambda mm: e2e.registers(1, mm, 0xDCB2, 0x0701, 0)
SENSORS = [('a16', *A16), ('hps167s', *HPS)]
TIMEOUT = 200  # ms; a script on a busy machine answers well within
OWN = 1111  # what the sensor says
BAD = 2222  # what nobody may be shown


def distances(done):
    """Of the csv that a run has written."""
    return [int(row.split(',')[9]) for row in done.out.splitlines()[1:]]


class Asked(e2e.Case):
    """A script for each request: bytes are written, numbers are pauses in seconds."""

    def play(self, which, *scripts, arguments=()):
        sensor, request, _ = which
        device = self.device()
        reader = self.fathom('read', *sensor, '--port', device.path, '--count', len(scripts), '--timeout', TIMEOUT,
                             '--format', 'csv', *arguments)
        for script in scripts:
            self.assertEqual(device.read(len(request)), request)
            for step in script:
                if isinstance(step, bytes):
                    device.write(step)
                else:
                    select.select([reader.pidfd], [], [], step)
        done = reader.finish(5)
        # each attempt takes its time-out, and as long again for what is owed
        self.assertLess(done.elapsed, 2 + 2 * len(scripts) * TIMEOUT / 1000)
        return done

    def each(self, expected, code, words, *make):
        """make: for each request, what the answering function gives a script from. expected: what is shown."""
        for name, *which in SENSORS:
            with self.subTest(name):
                answer = which[2]
                done = self.play(which, *(one(answer) for one in make))
                self.assertEqual((distances(done), done.code), (expected, code), done.err)
                if words:
                    self.assertRegex(done.err, words)
                else:
                    self.assertNotIn('attempt 1', done.err)
                self.assertIn(f'attempts {len(make)}, ', done.err)

    @staticmethod
    def good(answer):
        return [answer(OWN)]

    def test_garbage_before_the_answer(self):
        self.each([OWN] * 2, 0, '', lambda answer: [b'\x00\x55\xFE\x80' + answer(OWN)], self.good)

    def test_garbage_that_looks_like_the_beginning_of_an_answer(self):
        self.each([OWN] * 2, 0, '', lambda answer: [b'\x01\x03' + answer(OWN)], self.good)

    def test_the_answer_in_two_writes_with_a_pause(self):
        for cut in (1, 3, 5):
            self.each([OWN] * 2, 0, '', lambda answer: [answer(OWN)[:cut], 0.015, answer(OWN)[cut:]], self.good)

    def test_an_answer_byte_by_byte(self):
        self.each([OWN], 0, '', lambda answer: [answer(OWN)[i:i + 1] for i in range(len(answer(OWN)))])

    def test_an_answer_of_another_unit(self):
        def other(answer):
            body = b'\x02' + answer(BAD)[1:-2]
            return [body + e2e.crc16(body)]
        self.each([OWN], 1, 'attempt 1: no answer from address 1: .* try --address 2', other, self.good)

    def test_an_answer_of_another_unit_before_the_own(self):
        def other(answer):
            body = b'\x02' + answer(BAD)[1:-2]
            return [body + e2e.crc16(body) + answer(OWN)]
        self.each([OWN] * 2, 0, '', other, self.good)

    def test_a_wrong_count_with_a_right_crc(self):
        for count in (2, 3, 5):
            self.each([OWN], 1, 'attempt 1: address 1 answered something else than was asked',
                      lambda answer: [e2e.registers(1, *[BAD] * count)], self.good)

    def test_another_function_with_a_right_crc(self):
        self.each([OWN], 1, 'attempt 1: address 1 answered something else than was asked',
                  lambda answer: [e2e.adu(1, 6, 1, 0, *divmod(BAD, 256))], self.good)

    def test_a_truncated_answer_at_every_length(self):
        for name, *which in SENSORS:
            whole = which[2](BAD)
            for length in range(1, len(whole)):
                with self.subTest(f'{name} {length}'):
                    done = self.play(which, [whole[:length]])
                    self.assertEqual((distances(done), done.code), ([], 1))
                    self.assertRegex(done.err, 'attempt 1: (the answer of address 1 was damaged|no answer from address 1)')

    def test_what_follows_a_truncated_answer_is_not_joined_to_it(self):
        self.each([OWN], 1, 'attempt 1: the answer of address 1 was damaged', lambda answer: [answer(BAD)[:5]], self.good)

    def test_trailing_bytes(self):
        self.each([OWN] * 3, 0, '', *[lambda answer: [answer(OWN) + b'\x00\xFE\x55']] * 3)

    def test_a_late_answer_is_told_and_not_shown(self):
        # as late as two time-outs, the last moment in which it can be told from the next one's answer
        late = 1.5 * TIMEOUT / 1000
        self.each([OWN], 1, 'late answers 1', lambda answer: [late, answer(BAD)], self.good)

    def test_an_answer_twice(self):
        """The second copy comes before the next request and belongs to nobody."""
        self.each([OWN] * 2, 0, '', lambda answer: [answer(OWN) * 2], self.good)

    def test_a_flipped_bit_in_every_byte(self):
        for name, *which in SENSORS:
            whole = which[2](BAD)
            scripts = []
            for at in range(len(whole)):
                flipped = bytearray(whole)
                flipped[at] ^= 1 << 3 * at % 8
                scripts.append([bytes(flipped)])
            with self.subTest(name):
                done = self.play(which, *scripts)
                self.assertEqual((distances(done), done.code), ([], 1))
                failed = re.findall(r'attempt \d+: (the answer of address 1 was damaged|no answer)', done.err)
                self.assertEqual(len(failed), len(scripts))

    def test_an_exception(self):
        self.each([OWN], 1, r'attempt 1: address 1 refused: exception 04 \(device failure\)',
                  lambda answer: [e2e.adu(1, 0x83, 4)], self.good)

    def test_silence(self):
        self.each([OWN], 1, 'attempt 1: no answer from address 1: nothing was heard at all', lambda answer: [], self.good)

    def test_an_unasked_frame_in_a_pause(self):
        for name, *which in SENSORS:
            with self.subTest(name):
                sensor, request, answer = which
                device = self.device()
                reader = self.fathom('read', *sensor, '--port', device.path, '--count', 2, '--interval', 500, '--format',
                                     'csv', '--timeout', TIMEOUT)
                device.read(len(request))
                device.write(answer(OWN))
                reader.expect(f',{OWN},')
                device.write(answer(BAD))
                device.read(len(request))
                device.write(answer(OWN))
                done = reader.finish(5)
                self.assertEqual((distances(done), done.code), ([OWN] * 2, 0))

    def test_the_echo_of_the_request_before_the_answer(self):
        for arguments in ((), ('--echo', 'on')):
            for name, *which in SENSORS:
                with self.subTest(f'{name} {arguments}'):
                    echo = which[1]
                    done = self.play(which, *[[echo, which[2](OWN)], [echo, 0.05, which[2](OWN)], [echo + which[2](OWN)]],
                                     arguments=arguments)
                    self.assertEqual((distances(done), done.code), ([OWN] * 3, 0), done.err)
                    self.assertIn('attempts 3, failed 0, readings 3\nfathom: line: answers 3\n', done.err)

    def test_an_echo_and_a_damaged_answer(self):
        for name, *which in SENSORS:
            with self.subTest(name):
                flipped = bytearray(which[2](BAD))
                flipped[3] ^= 2
                done = self.play(which, [which[1] + bytes(flipped)], [which[1] + which[2](OWN)])
                self.assertEqual((distances(done), done.code), ([OWN], 1))
                self.assertIn('attempt 1: the answer of address 1 was damaged', done.err)

    def test_figures_that_the_sensor_cannot_mean(self):
        self.each([OWN], 1, 'attempt 1: a value that cannot be a distance: 40000', lambda answer: [answer(40000)], self.good)

    def test_random_bytes(self):
        """Garbage of every kind, a good answer between: of 24 bits of CRC and address none of these can be right,
        which the first assertion makes sure of."""
        noise = random.Random(5)
        blocks = [noise.randbytes(noise.randrange(1, 40)) for _ in range(6)]
        for block in blocks:
            for at in range(len(block)):
                for end in range(at + 5, len(block) + 1):
                    self.assertNotEqual(e2e.crc16(block[at:end - 2]), block[end - 2:end])
        for name, *which in SENSORS:
            with self.subTest(name):
                scripts = [script for block in blocks for script in ([block], [0.03, which[2](OWN)])]
                done = self.play(which, *scripts)
                self.assertTrue(set(distances(done)) == {OWN}, done.out)
                self.assertEqual(done.code, 1)


class Sending(e2e.Case):
    """Streams: of A16 and A05 frames with a mistake in each; one frame in 60 ms, so that pauses can be seen."""
    VALUES = {'a16': (1953,), 'a05': (1000, 2000, 1953, 3562)}

    def stream(self, sensor, blocks, count=4, pause=0.06, timeout=500):
        """Plays the blocks over and over until the reader has made its attempts."""
        device = self.device()
        reader = self.fathom('read', sensor, '--port', device.path, '--count', count, '--timeout', timeout,
                             '--format', 'csv')
        reader.expect('^sensor,')
        at = 0
        deadline = time.monotonic() + e2e.PATIENCE
        while not select.select([reader.pidfd], [], [], pause)[0] and time.monotonic() < deadline:
            device.write(blocks[at % len(blocks)])
            at += 1
        done = reader.finish(5)
        self.assertLess(done.elapsed, 2 + count * max(timeout / 1000, 4 * pause * len(blocks)))
        return done

    def shown(self, done, sensor):
        """Nothing but the sensor's own values, each from its own probe."""
        got = [(int(row.split(',')[3]), int(row.split(',')[9])) for row in done.out.splitlines()[1:]]
        for probe, mm in got:
            self.assertEqual(mm, self.VALUES[sensor][probe - 1], got)
        return len(got)

    def mixed(self, spoil, code=0):
        """A spoilt frame, a good one, and so on: the good ones are shown."""
        for sensor, values in self.VALUES.items():
            with self.subTest(sensor):
                good = e2e.frame(*values)
                done = self.stream(sensor, [spoil(good), good])
                self.assertEqual((self.shown(done, sensor), done.code), (4 * len(values), code), done.err)
                self.assertRegex(done.err, r'line: frames \d+, ')

    def never(self, spoil, words):
        """Only spoilt ones: nothing is shown, and it is told."""
        for sensor, values in self.VALUES.items():
            with self.subTest(sensor):
                done = self.stream(sensor, [spoil(e2e.frame(*values))], count=1)
                self.assertEqual((self.shown(done, sensor), done.code), (0, 1), done.err)
                self.assertRegex(done.err, f'attempt 1: {words}')

    def test_a_flipped_bit(self):
        def flip(frame):
            return frame[:1] + bytes([frame[1] ^ 4]) + frame[2:]
        self.mixed(flip)
        self.never(flip, 'bytes were heard, but no frame of')

    def test_a_dropped_byte(self):
        def drop(frame):
            return frame[:2] + frame[3:]
        self.mixed(drop)
        self.never(drop, 'bytes were heard, but no frame of')

    def test_an_added_byte(self):
        def insert(frame):
            return frame[:2] + b'\x33' + frame[2:]
        self.mixed(insert)
        self.never(insert, 'bytes were heard, but no frame of')

    def test_a_truncated_frame(self):
        def cut(frame):
            return frame[:-1]
        self.mixed(cut)
        self.never(cut, 'bytes were heard, but no frame of')

    def test_frames_that_come_shifted_by_some_bytes(self):
        """Each write ends a frame and begins the next, so that the pauses are in the middle of frames. (Where a
        shifted frame that is valid follows a pause, nobody could tell it from a right one.)"""
        for sensor, values in self.VALUES.items():
            frame = e2e.frame(*values)
            for shift in (1, len(frame) // 2, len(frame) - 1):
                with self.subTest(f'{sensor} {shift}'):
                    done = self.stream(sensor, [frame[shift:] + frame[:shift]], count=1, timeout=300)
                    self.assertEqual(done.code, 0 if self.shown(done, sensor) else 1)

    def test_frames_without_pauses_of_which_the_beginning_was_missed(self):
        """FF 03 E8 07 D0 07 FF 05 3B 07: six bytes further it is 1339 2047 1000 2000 with a right sum. And 511 mm is
        FF 01 FF FF, a byte further 65281. Neither may be shown as what it is not."""
        for sensor, values in (('a05', (1000, 2000, 2047, 1339)), ('a16', (511,)), ('a16', (1953,))):
            frame = e2e.frame(*values)
            for shift in range(len(frame)):
                if (shift, len(frame)) == (6, 10):
                    continue  # a valid frame at the very beginning, which may be a pause
                with self.subTest(f'{sensor} {values} {shift}'):
                    device = self.device()
                    reader = self.fathom('read', sensor, '--port', device.path, '--count', 1, '--timeout', 200,
                                         '--format', 'csv')
                    reader.expect('^sensor,')
                    device.write(frame[shift:] + frame * 12)
                    done = reader.finish(5)
                    for row in done.out.splitlines()[1:]:
                        self.assertEqual(int(row.split(',')[9]), values[int(row.split(',')[3]) - 1])
                    is_shown = done.out.count('\n') > 1
                    self.assertTrue(is_shown or values != (1953,))
                    self.assertEqual(done.code, 0 if is_shown else 1)
                    self.assertNotIn('nothing was heard', done.err)

    def test_a_stuck_line(self):
        for byte in (0x00, 0xFF, 0x55):
            for sensor in self.VALUES:
                with self.subTest(f'{sensor} {byte:02X}'):
                    done = self.stream(sensor, [bytes([byte]) * 20], count=1)
                    self.assertEqual((done.out.count('\n'), done.code), (1, 1))
                    self.assertIn('attempt 1: bytes were heard', done.err)

    def test_a_sensor_that_falls_silent_is_not_shown_again(self):
        for sensor, values in self.VALUES.items():
            with self.subTest(sensor):
                device = self.device()
                reader = self.fathom('read', sensor, '--port', device.path, '--count', 6, '--timeout', 150, '--format', 'csv')
                reader.expect('^sensor,')
                while len(reader.seen['out']) < 1 + len(values):
                    device.write(e2e.frame(*values))
                    select.select([reader.pidfd], [], [], 0.06)
                done = reader.finish(5)
                self.assertEqual(done.code, 1)
                self.assertLess(self.shown(done, sensor), 6 * len(values))
                self.assertIn('attempt 6: nothing was heard at all', done.err)

    def test_random_bytes_between_good_frames(self):
        noise = random.Random(7)
        for sensor, values in self.VALUES.items():
            with self.subTest(sensor):
                good = e2e.frame(*values)
                blocks = [block for _ in range(8)
                          for block in (bytes(noise.randrange(255) for _ in range(noise.randrange(1, 30))), good)]
                done = self.stream(sensor, blocks, count=8)
                self.assertEqual((self.shown(done, sensor), done.code), (8 * len(values), 0), done.err)


if __name__ == '__main__':
    e2e.main()
