#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom scan where not all is well: sensors that send by themselves, no sensors, two with one address, other
protocols, ports that fail, and an end before it has finished."""
import os
import re
import signal

import e2e
from scanning import PATIENT, Case


class Automatic(Case):
    @e2e.each(an_a16_that_sends_is_named_and_nothing_is_sent_to_it=('a16', 1),
              an_a05_that_sends_is_named_and_nothing_is_sent_to_it=('a05', 4))
    def sending(self, name, probes):
        sim = self.sim(f'{name} --counters')
        self.scan(sim, '--listen 2',
                  'nothing was sent, because even a read ends what an A16 or A05 sends by itself', '--wake')
        self.assertEqual([(one['kind'], one['model'], one['mode'], one['address']) for one in self.found],
                         [('sensor', name, 'auto', None)])
        self.assertEqual(self.found[0]['next'], f'fathom read {name} --port {sim}')
        self.assertEqual(len(self.read_json(f'{name} --port {sim} --count 1')), probes)
        self.assertGreater(self.expect_unasked(sim)['automatic'], 4)

    def test_an_hps167s_that_sends_unasked_is_named_at_its_rate(self):
        sim = self.sim('hps167s:3 --with unasked=180 --baud 57600 --counters')
        self.scan(sim, '--listen 2',
                  'nothing was sent, because questions would go into what it sends; --wake')
        self.assertEqual([(one['model'], one['address'], one['baud'], one['next']) for one in self.found],
                         [('hps167s', 3, 57600,
                           f'fathom read hps167s --address 3 --baud 57600 --port {sim}')])
        self.expect_unasked(sim)

    def test_with_wake_it_is_asked_and_how_it_sends_again_is_told(self):
        sim = self.sim('a16:2 --counters')
        self.scan(sim, '--wake --address 1-3 --baud 9600 --listen 2 --timeout 500',
                  'sends again after power-off, or when 1 is written to its register 0x0202')
        self.assertEqual([(one['model'], one['mode'], one['address']) for one in self.found],
                         [('a16', 'modbus', 2)])
        self.assertEqual(self.expect_unharmed(sim)[0]['resets'], 0)

    def test_another_master_is_told_and_not_disturbed(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --listen 2')
        program.expect('takes about', 'err')
        for _ in range(3):
            device.write(e2e.adu(5, 3, 1, 0, 0, 1))
            self.assertTrue(device.is_silent(0.2))
        done = self.ends(program, 1, 'nothing was sent, because another master asks on this line')
        self.assertRegex(done.out, r'^\? +address 5 .*another master asks this address')


class Trouble(Case):
    def test_nothing_at_all_is_advised_and_is_1(self):
        done = self.scan(self.device(), '--address 1 --listen 1',
                         'no sensor was found: nothing was heard at all; check the supply, and A and B',
                         'sensors found: 0', code=1)
        self.assertEqual(self.found, [])
        self.assertNotIn('--baud all', done.err)  # the user chose the range

    def test_the_default_scan_advises_a_wider_one(self):
        self.scan(self.device(), '--listen 1 --timeout 10', 'found with --address 1-254 --baud all', code=1)

    def test_an_echo_without_a_sensor_is_told(self):
        self.scan(self.sim('hps167s:20 --echo'), '--address 1-2 --listen 1',
                  "only the tool's own requests came back", code=1)

    def test_two_with_one_address_are_told(self):
        sim = self.sim('hps167s:3 hps167s:3 hps167s:4 --counters')
        self.scan(sim, f'--address 2-4 --baud 19200 {PATIENT}',
                  'answers at address 3 (19200 8E1) are damaged: two sensors with one address?')
        self.assertEqual({one['address']: one['kind'] for one in self.found}, {3: 'damaged', 4: 'sensor'})
        self.expect_unharmed(sim)

    @e2e.each(
        answers_that_are_no_modbus_are_told_with_the_older_units=(
            lambda request: b'\x55\x80\x04\x71\x99', '--timeout 200', ('not_modbus', None, None),
            'something answers at 19200 8E1, but not Modbus: an HPS-167S made before 2020-09'),
        whoever_refuses_everything_is_another_modbus_device=(
            lambda request: e2e.adu(request[0], 0x83, 2) if request[0] == 2 else b'', '',
            ('other_modbus', None, 2)))
    def answered(self, answer, options, found, *said):
        """Every request is answered so until the scan ends."""
        device = self.device()
        program = self.fathom(f'scan --port {device} --format json {PATIENT} --address 1-3 --baud 19200 {options}')
        while not program.has_ended():
            if not device.is_silent(0.02):
                device.write(answer(device.read(8)))
        done = self.ends(program, 1, *said)
        self.assertEqual([(one['kind'], one['model'], one['address']) for one in done.json], [found])
        self.assertIsNone(done.json[0]['next'])

    def test_a_port_that_is_not_there_is_1(self):
        self.ends(f'scan --port {self.path("nowhere")}', 1, re.compile('^fathom: .*nowhere: no such device'),
                  out='')

    def test_a_port_that_is_lost_is_1_and_said(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --listen 1')
        device.read(8)
        device.hang_up()
        self.ends(program, 1, re.compile(r'connect it again and start again.*\n\Z'))

    def test_ctrl_c_keeps_what_was_found(self):
        program = self.fathom(f'scan --port {self.sim("hps167s:1")} --baud 19200 --address 1-254 --listen 1')
        program.expect('^hps167s +address 1 ')
        self.ends(program.end(signal.SIGINT), 0, 'ended before all addresses were asked; sensors found: 1')

    def test_a_reader_that_has_seen_enough_ends_it(self):
        sim = self.sim('hps167s:1 hps167s:2')
        out, pipe = os.pipe()
        program = self.fathom(f'scan --port {sim} --baud 19200 --address 1-254 --listen 1', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            self.assertIn('address 1 ', stdout.readline())
        self.ends(program.finish(10), 1)  # all addresses take half a minute


if __name__ == '__main__':
    e2e.main()
