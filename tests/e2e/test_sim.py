#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim as a program: its path, its link, its end, and what it sends, judged without the library."""
import os
import signal
import time

import serial

import e2e


class Link(e2e.Case):
    def test_the_path_is_the_only_line_of_stdout_and_the_link_is_there_by_then(self):
        link = self.path('tof')
        sim = self.sim('hps167s', '--link', link)
        self.assertEqual(os.readlink(link), sim.port)
        sim.expect(rf'simulates hps167s, mode modbus, address 1, 19200 8E1.*fathom read hps167s --port {link}$', 'err')
        done = sim.end()
        self.assertEqual((done.code, done.out), (0, f'{sim.port}\n'))

    def test_the_link_goes_with_every_end_that_can_be_seen(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number):
                link = self.path('tof')
                sim = self.sim('hps167s', '--link', link)
                self.assertTrue(os.path.islink(link))
                self.assertEqual(sim.end(number).code, 0)
                self.assertFalse(os.path.lexists(link))

    def test_a_link_that_was_left_behind_is_replaced(self):
        link = self.path('tof')
        self.sim('a16', '--link', link).end(signal.SIGKILL)
        self.assertTrue(os.path.lexists(link))
        sim = self.sim('a16', '--link', link, '--distance', '754')
        self.assertEqual(self.read_json('a16', '--port', link, '--count', '1')[0]['distance_mm'], 754)
        sim.end()
        self.assertFalse(os.path.lexists(link))

    def test_a_link_that_is_now_anothers_stays(self):
        link = self.path('tof')
        first = self.sim('a16', '--link', link)
        second = self.sim('a16', '--link', link)
        self.assertEqual(first.end().code, 0)
        self.assertEqual(os.readlink(link), second.port)

    def test_a_file_in_the_way_is_kept_and_told(self):
        with open(self.path('tof'), 'w', encoding='ascii') as file:
            file.write('precious')
        done = self.run_fathom('sim', 'a16', '--link', self.path('tof'))
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertIn(f'{self.path("tof")} is there already and is no link', done.err)
        with open(self.path('tof'), encoding='ascii') as file:
            self.assertEqual(file.read(), 'precious')

    def test_a_folder_that_is_not_there_is_told(self):
        done = self.run_fathom('sim', 'a16', '--link', self.path('no/tof'))
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertRegex(done.err, r'^fathom: the simulated port and its link .*/no/tof: No such file or directory\n$')

    def test_the_hint_names_what_is_not_the_factorys(self):
        sim = self.sim('a16:7:modbus')
        sim.expect(rf'fathom read a16 --mode modbus --address 7 --port {sim.port}$', 'err')


class Port(e2e.Case):
    """Through pyserial, byte for byte."""

    def open(self, sim, **settings):
        port = serial.Serial(sim.port, timeout=e2e.PATIENCE, **settings)
        self.addCleanup(port.close)
        return port

    def test_an_a16_sends_the_datasheets_frame(self):
        sim = self.sim('a16', '--distance', '1953')
        data = self.open(sim, baudrate=9600).read(12)
        self.assertIn(bytes.fromhex('FF 07 A1 A7'), data)

    def test_an_a05_sends_the_datasheets_frame(self):
        sim = self.sim('a05', '--distance', '1000,2000,1953,3562')
        data = self.open(sim, baudrate=9600).read(30)
        self.assertIn(bytes.fromhex('FF 03 E8 07 D0 07 A1 0D EA 60'), data)

    def asked(self, device, distance, request, answer, **settings):
        sim = self.sim(device, '--distance', distance)
        port = self.open(sim, **settings)
        port.write(bytes.fromhex(request))
        self.assertEqual(port.read(len(bytes.fromhex(answer))).hex(' '), bytes.fromhex(answer).hex(' '))

    def test_an_a16_answers_as_in_the_datasheet(self):
        self.asked('a16::modbus', '754', '01 03 01 00 00 01 85 F6', '01 03 02 02 F2 38 A1')

    def test_an_a05_answers_as_in_the_datasheet(self):
        self.asked('a05::modbus', '100,250,659,2426', '01 03 01 07 00 03 B5 F6', '01 03 06 00 FA 02 93 09 7A 8F 47')

    def test_an_hps167s_answers_as_in_the_datasheet(self):
        self.asked('hps167s', '2083', '01 03 00 08 00 04 C5 CB', '01 03 08 08 23 DC B2 07 01 00 00 FD 41', baudrate=19200)

    def test_an_hps167s_refuses_a_wrong_length_as_in_the_datasheet(self):
        self.asked('hps167s', '2083', e2e.adu(1, 3, 0, 8, 0, 3).hex(), '01 83 02 C0 F1', baudrate=19200)

    def test_it_moves_by_itself_and_starts_where_the_seed_says(self):
        seen = []
        for seed in ('0', '2000000'):  # 2 s further in the movement; reading takes much less
            sim = self.sim('hps167s', '--seed', seed)
            objects = self.read_json('hps167s', '--port', sim.port, '--count', '10')
            distances = [one['distance_mm'] for one in objects]
            self.assertEqual(distances, sorted(set(distances)))
            self.assertTrue(500 <= distances[0] and distances[-1] <= 12000, distances)
            seen.append(distances)
        self.assertGreater(seen[1][0], seen[0][0])

    def test_it_sleeps_when_nobody_asks(self):
        sim = self.sim('hps167s')
        began = time.monotonic()
        self.run_fathom('read', 'a16', '--port', self.device().path, '--timeout', '2000', '--count', '1')
        self.assertGreater(time.monotonic() - began, 1.9)
        self.assertLess(sim.end().cpu, 0.2)

    def test_it_goes_on_when_nobody_reads_its_stdout(self):
        out, pipe = os.pipe()
        sim = self.fathom('sim', 'a16', '--distance', '754', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            port = stdout.readline().strip()
        self.assertEqual(self.read_json('a16', '--port', port, '--count', '2')[1]['distance_mm'], 754)
        self.assertEqual(sim.end().code, 0)


if __name__ == '__main__':
    e2e.main()
