#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim --fault as a program: its help, its errors, and what a client sees of the faults, in raw bytes."""
import re

import serial

import e2e

KINDS = ('stuck interference fault no-target unit function count exception flip-bit flip-byte drop insert truncate '
         'trailing parity framing overrun split duplicate delay late silence power-cycle noise unasked break echo').split()
A16_FRAME = bytes.fromhex('FF 02 EF F0')  # 751 mm: FF + 02 + EF = 1F0
ASK_754 = bytes.fromhex('01 03 01 00 00 01 85 F6')  # A16 6(4)
ANSWER_754 = bytes.fromhex('01 03 02 02 F2 38 A1')
ASK_ALL = bytes.fromhex('55 AA 01 01 01')  # A05 2(3)3
ANSWER_ALL = bytes.fromhex('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62')


class Usage(e2e.Case):
    def test_help_lists_every_kind_with_a_few_words(self):
        done = self.run_fathom('sim', '--help')
        self.assertEqual(done.code, 0)
        listed = re.findall(r'(?:^ {4}|  )([a-z-]+) +\S', done.out.split('The kinds:')[1].split('A pseudo terminal')[0], re.M)
        self.assertEqual([word for word in listed if word in KINDS], KINDS)
        self.assertIn('cannot mark a byte', done.out)

    def wrong(self, *arguments):
        done = self.run_fathom('sim', *arguments)
        self.assertEqual((done.code, done.out), (2, ''), done.err)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        return done.err

    def test_a_wrong_kind_lists_those_there_are(self):
        for kind in ('flip', '', '=0.5', 'clock-jump', 'x' * 200):
            with self.subTest(kind):
                said = self.wrong('a16', '--fault', kind)
                self.assertIn(f"there is no fault '{kind.split('=')[0]}' for a16 in mode auto, only ", said)
                self.assertEqual(said.split('only ')[1].split('; try')[0].split(', '), [k for k in KINDS if k != 'fault'])

    def test_a_kind_that_the_sensor_cannot_have_is_wrong(self):
        self.assertIn("no fault 'interference' for hps167s", self.wrong('hps167s', '--fault', 'interference'))
        self.assertIn("no fault 'fault' for a05 in mode dyp", self.wrong('a05::dyp', '--fault', 'fault'))

    def test_a_wrong_number_says_what_is_right(self):
        for number in ('', '0', '0.0', '2', '1.1', '101%', '-1', '+1', '0,5', '1e-3', '5 %', '%', '.', '5%%', '0x1', '0.0000001',
                       '0.00001%', '1@', '1@0', '1@-1', '1@x', '1@4294967296', '@3', '1@2@3', ' 1', '9' * 40):
            with self.subTest(number):
                said = self.wrong('a16', '--fault', f'drop={number}')
                self.assertIn(f"--fault takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%, N from 1, not 'drop={number}'", said)

    def test_one_wrong_among_good_ones_is_found(self):
        self.assertIn("not 'late=7'", self.wrong('a16', '--fault', 'drop=1%', '--fault', 'late=7', '--fault', 'insert'))

    def test_there_may_be_32_and_no_more(self):
        self.assertIn('--fault may be given up to 32 times', self.wrong('a16', *['--fault', 'drop'] * 33))
        self.assertEqual(self.sim('a16', *['--fault', 'drop=1%'] * 32).end().code, 0)

    def test_a_value_is_needed(self):
        self.assertIn('--fault needs a value', self.wrong('a16', '--fault'))


class Seen(e2e.Case):
    def open(self, *arguments, **settings):
        sim = self.sim(*arguments)
        port = serial.Serial(sim.port, timeout=e2e.PATIENCE, **settings)
        self.addCleanup(port.close)
        return port

    def asked(self, port, request, length):
        port.write(request)
        return port.read(length)

    def test_the_second_of_three_answers_is_damaged(self):
        port = self.open('a16::modbus', '--distance', '754', '--fault', 'trailing=1@2')
        self.assertEqual(self.asked(port, ASK_754, 7), ANSWER_754)
        damaged = self.asked(port, ASK_754, 8)
        self.assertEqual(damaged[:7], ANSWER_754)
        port.timeout = 0.1
        port.read(3)  # the rest, up to four bytes in all
        port.timeout = e2e.PATIENCE
        self.assertEqual(self.asked(port, ASK_754, 7), ANSWER_754)

    def test_two_faults_at_once(self):
        port = self.open('a16::modbus', '--distance', '754', '--fault', 'echo', '--fault', 'duplicate=100%')
        self.assertEqual(self.asked(port, ASK_754, 22), ASK_754 + ANSWER_754 + ANSWER_754)

    def test_an_a05_speaks_55_aa_and_modbus(self):
        port = self.open('a05::dyp', '--distance', '1000,2000,1953,3562')
        self.assertEqual(self.asked(port, ASK_ALL, 13), ANSWER_ALL)
        self.assertEqual(self.asked(port, bytes.fromhex('55 AA 01 12 12'), 7), bytes.fromhex('55 AA 01 12 07 A1 BA'))
        self.assertEqual(self.asked(port, e2e.adu(1, 3, 2, 0, 0, 1), 7), e2e.adu(1, 3, 2, 0, 1))

    def test_a_damaged_55_aa_answer(self):
        port = self.open('a05::dyp', '--distance', '1000,2000,1953,3562', '--fault', 'count=1@1')
        self.assertEqual(self.asked(port, ASK_ALL, 11), bytes.fromhex('55 AA 01 01 03 E8 07 D0 07 A1 6B'))
        self.assertEqual(self.asked(port, ASK_ALL, 13), ANSWER_ALL)

    def test_one_bit_is_wrong_in_half_of_the_frames(self):
        """Of the frames that a client reads as they come, four bytes each; 40 of them, at 10 Hz."""
        port = self.open('a16', '--distance', '751', '--fault', 'flip-bit=0.5', '--seed', '3')
        frames = [port.read(4) for _ in range(40)]
        bad = [frame for frame in frames if frame != A16_FRAME]
        for frame in bad:
            self.assertEqual(sum(bin(a ^ b).count('1') for a, b in zip(frame, A16_FRAME)), 1, frame.hex(' '))
        self.assertTrue(4 <= len(bad) <= 36, len(bad))  # 20 and five sigma of 3.16

    def test_a_marked_byte_comes_as_a_terminal_gives_it(self):
        port = self.open('a16', '--distance', '751', '--fault', 'break')
        self.assertEqual(port.read(10), (b'\0' + A16_FRAME) * 2)
        port = self.open('a16', '--distance', '751', '--fault', 'overrun')
        three = port.read(3)
        self.assertIn(three, [A16_FRAME[:n] + A16_FRAME[n + 1:] for n in range(4)])

    def test_a_pause_inside_a_frame_is_a_pause_for_the_client(self):
        """An answer comes in two parts. A busy machine may hand over both at once, but not every time."""
        port = self.open('a16::modbus', '--distance', '754', '--fault', 'split')
        for _ in range(50):
            head = self.asked(port, ASK_754, 1)
            head += port.read(port.in_waiting)
            self.assertEqual(head + port.read(7 - len(head)), ANSWER_754)
            if len(head) < 7:
                return
        self.fail('50 answers came in one part')

    def test_the_tool_tells_what_was_wrong(self):
        sim = self.sim('a16::modbus', '--distance', '754', '--fault', 'exception=1@1', '--fault', 'flip-byte=1@2')
        done = self.run_fathom('read', 'a16', '--mode', 'modbus', '--port', sim.port, '--count', '3', '--format', 'json')
        self.assertEqual(done.code, 1)
        self.assertIn('"distance_mm":754', done.out.splitlines()[-1].replace(' ', ''))
        self.assertIn('exception', done.out + done.err)


if __name__ == '__main__':
    e2e.main()
