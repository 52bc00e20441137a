#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim as a program: its path, its link, its end, and what it sends, judged without the library."""
import os
import re
import signal

import e2e
from simulated import Case


class Link(Case):
    def setUp(self):
        super().setUp()
        self.link = self.path('tof')

    def test_the_path_is_the_only_line_of_stdout_and_the_link_is_there_by_then(self):
        sim = self.sim(f'hps167s --link {self.link}')
        self.assertEqual(os.readlink(self.link), sim.port)
        sim.expect('simulates hps167s, mode modbus, address 1, 19200 8E1.*fathom read hps167s --port '
                   f'{self.link}$', 'err')
        self.ends(sim.end(), 0, out=f'{sim.port}\n')

    def test_the_link_goes_with_every_end_that_can_be_seen(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            sim = self.sim(f'hps167s --link {self.link}')
            self.assertTrue(os.path.islink(self.link))
            self.assertEqual(sim.end(number).code, 0)
            self.assertFalse(os.path.lexists(self.link))

    def test_a_link_that_was_left_behind_is_replaced(self):
        self.sim(f'a16 --link {self.link}').end(signal.SIGKILL)
        self.assertTrue(os.path.lexists(self.link))
        sim = self.sim(f'a16 --distance 754 --link {self.link}')
        self.assertEqual(self.read_json(f'a16 --port {self.link} --count 1')[0]['distance_mm'], 754)
        sim.end()
        self.assertFalse(os.path.lexists(self.link))

    def test_a_link_that_is_now_anothers_stays(self):
        first, second = (self.sim(f'a16 --link {self.link}') for _ in range(2))
        self.assertEqual(first.end().code, 0)
        self.assertEqual(os.readlink(self.link), second.port)

    def test_a_file_in_the_way_is_kept_and_told(self):
        with open(self.link, 'w', encoding='ascii') as file:
            file.write('precious')
        self.ends(f'sim a16 --link {self.link}', 1, f'{self.link} is there already and is no link', out='')
        with open(self.link, encoding='ascii') as file:
            self.assertEqual(file.read(), 'precious')

    def test_a_folder_that_is_not_there_is_told(self):
        self.ends(f'sim a16 --link {self.path("no/tof")}', 1, re.compile(
            r'^fathom: the simulated port and its link .*/no/tof: No such file or directory\n$'), out='')

    def test_the_hint_names_what_is_not_the_factorys(self):
        sim = self.sim('a16:7:modbus')
        sim.expect(rf'fathom read a16 --mode modbus --address 7 --port {sim}$', 'err')


class Port(Case):
    """Through pyserial, byte for byte; the frames are those of the datasheets."""

    @e2e.each(an_a16_sends_the_datasheets_frame=('a16', '1953', 'FF 07 A1 A7'),
              an_a05_sends_the_datasheets_frame=('a05', '1000,2000,1953,3562',
                                                 'FF 03 E8 07 D0 07 A1 0D EA 60'))
    def sends(self, device, distance, text):
        frame = bytes.fromhex(text)
        self.assertIn(frame, self.open(self.sim(f'{device} --distance {distance}')).read(3 * len(frame)))

    @e2e.each(
        an_a16_answers_as_in_the_datasheet=('a16::modbus', '754', '01 03 01 00 00 01 85 F6',
                                            '01 03 02 02 F2 38 A1'),
        an_a05_answers_as_in_the_datasheet=('a05::modbus', '100,250,659,2426', '01 03 01 07 00 03 B5 F6',
                                            '01 03 06 00 FA 02 93 09 7A 8F 47'),
        an_hps167s_answers_as_in_the_datasheet=('hps167s', '2083', '01 03 00 08 00 04 C5 CB',
                                                '01 03 08 08 23 DC B2 07 01 00 00 FD 41'),
        an_hps167s_refuses_a_wrong_length_as_in_the_datasheet=('hps167s', '2083', '01 03 00 08 00 03 84 09',
                                                               '01 83 02 C0 F1'))
    def asked(self, device, distance, request, answer):
        port = self.open(self.sim(f'{device} --distance {distance}'))
        port.write(bytes.fromhex(request))
        self.assertEqual(port.read(len(bytes.fromhex(answer))).hex(' ').upper(), answer)

    def test_it_moves_by_itself_and_starts_where_the_seed_says(self):
        seen = []
        for seed in (0, 2000000):  # 2 s further in the movement; reading takes much less
            sim = self.sim(f'hps167s --seed {seed}')
            distances = [one['distance_mm'] for one in self.read_json(f'hps167s --port {sim} --count 10')]
            self.assertEqual(distances, sorted(set(distances)))
            self.assertTrue(500 <= distances[0] and distances[-1] <= 12000, distances)
            seen.append(distances)
        self.assertGreater(seen[1][0], seen[0][0])

    def test_it_sleeps_when_nobody_asks(self):
        sim = self.sim('hps167s')
        self.assertFalse(sim.has_ended(1.9))
        self.assertLess(sim.end().cpu, 0.2)

    def test_it_goes_on_when_nobody_reads_its_stdout(self):
        out, pipe = os.pipe()
        sim = self.fathom('sim a16 --distance 754', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            port = stdout.readline().strip()
        self.assertEqual(self.read_json(f'a16 --port {port} --count 2')[1]['distance_mm'], 754)
        self.assertEqual(sim.end().code, 0)


if __name__ == '__main__':
    e2e.main()
