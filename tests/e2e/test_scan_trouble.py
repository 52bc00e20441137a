#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom scan where not all is well: sensors that send by themselves, no sensors, two with one address, other protocols,
ports that fail, and an end before it has finished."""
import json
import os
import select
import shlex
import signal

import e2e
from scanning import PATIENT, Case


class Automatic(Case):
    def check(self, model, name):
        sim = self.sim(model, '--counters')
        done = self.scan(sim.port, '--listen', 2)
        self.assertEqual([(one['kind'], one['model'], one['mode'], one['address']) for one in self.found],
                         [('sensor', name, 'auto', None)])
        self.assertEqual(self.found[0]['next'], f'fathom read {name} --port {sim.port}')
        self.assertIn('nothing was sent, because even a read ends what an A16 or A05 sends by itself', done.err)
        self.assertIn('--wake', done.err)
        self.assertEqual(len(self.read_json(*shlex.split(self.found[0]['next'])[2:], '--count', 1)), 4 if name == 'a05' else 1)
        counters = self.counters(sim)[0]
        self.assertEqual((counters['requests'], counters['crc_errors'], counters['others']), (0, 0, 0))
        self.assertGreater(counters['automatic'], 4)

    def test_an_a16_that_sends_is_named_and_nothing_is_sent_to_it(self):
        self.check('a16', 'a16')

    def test_an_a05_that_sends_is_named_and_nothing_is_sent_to_it(self):
        self.check('a05', 'a05')

    def test_an_hps167s_that_sends_unasked_is_named_at_its_rate(self):
        sim = self.sim('hps167s:3', '--with', 'unasked=180', '--baud', '57600', '--counters')
        done = self.scan(sim.port, '--listen', 2)
        self.assertIn('nothing was sent, because questions would go into what it sends; --wake', done.err)
        self.assertEqual([(one['model'], one['address'], one['baud'], one['next']) for one in self.found],
                         [('hps167s', 3, 57600, f'fathom read hps167s --address 3 --baud 57600 --port {sim.port}')])
        counters = self.counters(sim)[0]
        self.assertEqual((counters['requests'], counters['crc_errors'], counters['others']), (0, 0, 0))

    def test_with_wake_it_is_asked_and_how_it_sends_again_is_told(self):
        sim = self.sim('a16:2', '--counters')
        done = self.scan(sim.port, '--wake', '--address', '1-3', '--baud', '9600', '--listen', 2, '--timeout', 500)
        self.assertEqual([(one['model'], one['mode'], one['address']) for one in self.found], [('a16', 'modbus', 2)])
        self.assertIn('sends again after power-off, or when 1 is written to its register 0x0202', done.err)
        self.assertEqual(self.expect_unharmed(sim)[0]['resets'], 0)

    def test_another_master_is_told_and_not_disturbed(self):
        device = self.device()
        program = self.fathom('scan', '--port', device.path, '--listen', 2)
        program.expect('takes about', 'err')
        for _ in range(3):
            device.write(e2e.adu(5, 3, 1, 0, 0, 1))
            self.assertTrue(device.is_silent(0.2))
        done = program.finish()
        self.assertEqual(done.code, 1)
        self.assertRegex(done.out, r'^\? +address 5 .*another master asks this address')
        self.assertIn('nothing was sent, because another master asks on this line', done.err)


class Trouble(Case):
    def test_nothing_at_all_is_advised_and_is_1(self):
        done = self.scan(self.device().path, '--address', '1', '--listen', 1, code=1)
        self.assertEqual(self.found, [])
        self.assertIn('no sensor was found: nothing was heard at all; check the supply, and A and B', done.err)
        self.assertNotIn('--baud all', done.err)  # the user chose the range
        self.assertIn('sensors found: 0', done.err)

    def test_the_default_scan_advises_a_wider_one(self):
        done = self.scan(self.device().path, '--listen', 1, '--timeout', 10, code=1)
        self.assertIn('found with --address 1-254 --baud all', done.err)

    def test_an_echo_without_a_sensor_is_told(self):
        sim = self.sim('hps167s:20', '--echo')
        done = self.scan(sim.port, '--address', '1-2', '--listen', 1, code=1)
        self.assertIn("only the tool's own requests came back", done.err)

    def test_two_with_one_address_are_told(self):
        sim = self.sim('hps167s:3', 'hps167s:3', 'hps167s:4', '--counters')
        done = self.scan(sim.port, '--address', '2-4', '--baud', '19200', *PATIENT)
        self.assertEqual({one['address']: one['kind'] for one in self.found}, {3: 'damaged', 4: 'sensor'})
        self.assertIn('answers at address 3 (19200 8E1) are damaged: two sensors with one address?', done.err)
        self.expect_unharmed(sim)

    def answer(self, answers, *arguments):
        """Every request is answered with answers(request) until the scan ends."""
        device = self.device()
        program = self.fathom('scan', '--port', device.path, '--format', 'json', *PATIENT, *arguments)
        while select.select([program.pidfd, device.master], [], [], e2e.PATIENCE)[0] != [program.pidfd]:
            device.write(answers(device.read(8)))
        done = program.finish()
        self.found = [json.loads(line) for line in done.out.splitlines()]
        return done

    def test_answers_that_are_no_modbus_are_told_with_the_older_units(self):
        done = self.answer(lambda request: b'\x55\x80\x04\x71\x99', '--address', '1-3', '--baud', '19200',
                           '--timeout', 200)
        self.assertEqual([(one['kind'], one['model'], one['address']) for one in self.found], [('not_modbus', None, None)])
        self.assertEqual(done.code, 1)
        self.assertIn('something answers at 19200 8E1, but not Modbus: an HPS-167S made before 2020-09', done.err)

    def test_whoever_refuses_everything_is_another_modbus_device(self):
        done = self.answer(lambda request: e2e.adu(request[0], 0x83, 2) if request[0] == 2 else b'', '--address', '1-3',
                           '--baud', '19200')
        self.assertEqual([(one['kind'], one['address'], one['next']) for one in self.found], [('other_modbus', 2, None)])
        self.assertEqual(done.code, 1)

    def test_a_port_that_is_not_there_is_1(self):
        done = self.run_fathom('scan', '--port', self.path('nowhere'))
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertRegex(done.err, '^fathom: .*nowhere: no such device')

    def test_a_port_that_is_lost_is_1_and_said(self):
        device = self.device()
        program = self.fathom('scan', '--port', device.path, '--listen', 1)
        device.read(8)
        device.hang_up()
        done = program.finish()
        self.assertEqual(done.code, 1)
        self.assertRegex(done.err.splitlines()[-1], 'connect it again and start again')

    def test_ctrl_c_keeps_what_was_found(self):
        sim = self.sim('hps167s:1')
        program = self.fathom('scan', '--port', sim.port, '--baud', '19200', '--address', '1-254', '--listen', 1)
        program.expect('^hps167s +address 1 ')
        done = program.end(signal.SIGINT)
        self.assertEqual(done.code, 0)
        self.assertIn('ended before all addresses were asked; sensors found: 1', done.err)

    def test_a_reader_that_has_seen_enough_ends_it(self):
        sim = self.sim('hps167s:1', 'hps167s:2')
        out, pipe = os.pipe()
        program = self.fathom('scan', '--port', sim.port, '--baud', '19200', '--address', '1-254', '--listen', 1, stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            self.assertIn('address 1 ', stdout.readline())
        done = program.finish(10)  # all addresses take half a minute
        self.assertEqual(done.code, 1)


if __name__ == '__main__':
    e2e.main()
