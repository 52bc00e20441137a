#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim --fault as a program: its help, its errors, and what a client sees of the faults, in raw
bytes."""
import re

import e2e
from e2e import ASK_A16, SAYS_754
from simulated import Case

KINDS = ('stuck interference fault no-target unit function count exception flip-bit flip-byte drop insert truncate '
         'trailing parity framing overrun split duplicate delay late silence power-cycle noise unasked break echo'
         ).split()
FRAME = bytes.fromhex('FF 02 EF F0')  # 751 mm: FF + 02 + EF = 1F0
ASK_ALL = bytes.fromhex('55 AA 01 01 01')  # A05 2(3)3
ANSWER_ALL = bytes.fromhex('55 AA 01 01 03 E8 07 D0 07 A1 0D EA 62')


class Usage(Case):
    def test_help_lists_every_kind_with_a_few_words(self):
        out = self.ends('sim --help', 0).out
        listed = re.findall(r'(?:^ {4}|  )([a-z-]+) +\S',
                            out.split('The kinds:')[1].split('A pseudo terminal')[0],
                            re.M)
        self.assertEqual([word for word in listed if word in KINDS], KINDS)
        self.assertIn('cannot mark a byte', out)

    def wrong(self, *line):
        done = self.ends(self.run_fathom('sim', *line), 2, out='')
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        return done.err

    @e2e.each(**{f'a_wrong_kind_lists_those_there_are_{number}': kind for number, kind in
                 enumerate(('flip', '', '=0.5', 'clock-jump', 'x' * 200))})
    def wrong_kind(self, kind):
        said = self.wrong('a16', ['--fault', kind])
        self.assertIn(f"there is no fault '{kind.split('=')[0]}' for a16 in mode auto, only ", said)
        self.assertEqual(said.split('only ')[1].split('; try')[0].split(', '),
                         [k for k in KINDS if k != 'fault'])

    def test_a_kind_that_the_sensor_cannot_have_is_wrong(self):
        self.assertIn("no fault 'interference' for hps167s", self.wrong('hps167s --fault interference'))
        self.assertIn("no fault 'fault' for a05 in mode dyp", self.wrong('a05::dyp --fault fault'))

    @e2e.each(**{f'a_wrong_number_says_what_is_right_{row}': text for row, text in enumerate((
        '', '0', '0.0', '2', '1.1', '101%', '-1', '+1', '0,5', '1e-3', '5 %', '%', '.', '5%%', '0x1',
        '0.0000001',
        '0.00001%', '1@', '1@0', '1@-1', '1@x', '1@4294967296', '@3', '1@2@3', ' 1', '9' * 40))})
    def wrong_number(self, text):
        self.assertIn('--fault takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%, N from 1, not '
                      f"'drop={text}'", self.wrong('a16', ['--fault', f'drop={text}']))

    def test_one_wrong_among_good_ones_is_found(self):
        self.assertIn("not 'late=7'", self.wrong('a16 --fault drop=1% --fault late=7 --fault insert'))

    def test_there_may_be_32_and_no_more(self):
        self.assertIn('--fault may be given up to 32 times', self.wrong('a16', '--fault drop ' * 33))
        self.assertEqual(self.sim('a16', '--fault drop=1% ' * 32).end().code, 0)

    def test_a_value_is_needed(self):
        self.assertIn('--fault needs a value', self.wrong('a16 --fault'))


class Seen(Case):
    def port(self, line):
        return self.open(self.sim(line))

    def asked(self, port, request, answer):
        port.write(request)
        self.assertEqual(port.read(len(answer)), answer)

    def test_the_second_of_three_answers_is_damaged(self):
        port = self.port('a16::modbus --distance 754 --fault trailing=1@2')
        self.asked(port, ASK_A16, SAYS_754)
        self.asked(port, ASK_A16, SAYS_754)
        self.assertEqual(len(port.read(1)), 1)
        port.timeout = 0.1
        port.read(3)  # the rest, up to four bytes in all
        port.timeout = e2e.PATIENCE
        self.asked(port, ASK_A16, SAYS_754)

    def test_two_faults_at_once(self):
        self.asked(self.port('a16::modbus --distance 754 --fault echo --fault duplicate=100%'), ASK_A16,
                   ASK_A16 + SAYS_754 + SAYS_754)

    def test_an_a05_speaks_55_aa_and_modbus(self):
        port = self.port('a05::dyp --distance 1000,2000,1953,3562')
        self.asked(port, ASK_ALL, ANSWER_ALL)
        self.asked(port, bytes.fromhex('55 AA 01 12 12'), bytes.fromhex('55 AA 01 12 07 A1 BA'))
        self.asked(port, e2e.adu(1, 3, 2, 0, 0, 1), e2e.adu(1, 3, 2, 0, 1))

    def test_a_damaged_55_aa_answer(self):
        port = self.port('a05::dyp --distance 1000,2000,1953,3562 --fault count=1@1')
        self.asked(port, ASK_ALL, bytes.fromhex('55 AA 01 01 03 E8 07 D0 07 A1 6B'))
        self.asked(port, ASK_ALL, ANSWER_ALL)

    def test_one_bit_is_wrong_in_half_of_the_frames(self):
        """Of the frames that a client reads as they come, four bytes each; 40 of them, at 10 Hz."""
        port = self.port('a16 --distance 751 --fault flip-bit=0.5 --seed 3')
        bad = [frame for frame in (port.read(4) for _ in range(40)) if frame != FRAME]
        for frame in bad:
            self.assertEqual(sum(bin(a ^ b).count('1') for a, b in zip(frame, FRAME)), 1, frame.hex(' '))
        self.assertTrue(4 <= len(bad) <= 36, len(bad))  # 20 and five sigma of 3.16

    def test_a_marked_byte_comes_as_a_terminal_gives_it(self):
        self.assertEqual(self.port('a16 --distance 751 --fault break').read(10), (b'\0' + FRAME) * 2)
        self.assertIn(self.port('a16 --distance 751 --fault overrun').read(3),
                      [FRAME[:n] + FRAME[n + 1:] for n in range(4)])

    def test_a_pause_inside_a_frame_is_a_pause_for_the_client(self):
        """An answer comes in two parts. A busy machine may hand over both at once, but not every time."""
        port = self.port('a16::modbus --distance 754 --fault split')
        for _ in range(50):
            port.write(ASK_A16)
            head = port.read(1)
            head += port.read(port.in_waiting)
            self.assertEqual(head + port.read(7 - len(head)), SAYS_754)
            if len(head) < 7:
                return
        self.fail('50 answers came in one part')

    def test_the_tool_tells_what_was_wrong(self):
        sim = self.sim('a16::modbus --distance 754 --fault exception=1@1 --fault flip-byte=1@2')
        done = self.ends(f'read a16 --mode modbus --port {sim} --count 3 --format json', 1, 'exception')
        self.assertEqual(done.json[-1]['distance_mm'], 754)


if __name__ == '__main__':
    e2e.main()
