#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom scan as a program: what it finds and prints, that it harms no device, and what it advises, also where
not all is well: sensors that send by themselves, no sensors, two with one address, other protocols, ports
that fail, an end before it has finished. How it judges what it hears, and how long it takes, is in
tests/devices/sim/test_scan*.c, in simulated time."""
import os
import pty
import re
import shlex
import signal
import termios

import e2e

EIGHT = 'a16:1:modbus a16:2:modbus a05:3:modbus a05:5:dyp hps167s:6 hps167s:7 hps167s:8 a16:9:modbus'
FOUND = {1: 'a16', 2: 'a16', 3: 'a05', 5: 'a05', 6: 'hps167s', 7: 'hps167s', 8: 'hps167s', 9: 'a16'}
# Far more than a simulated sensor takes on a busy machine; so that load makes it slow, not wrong.
PATIENT = '--listen 1 --timeout 500'


class Case(e2e.Case):
    def scan(self, port, options, *said, code=0):
        """To the end; the objects that it found are in .found."""
        done = self.run_fathom(f'scan --port {port} --format json {options}', seconds=100)
        self.found = self.ends(done, code, *said).json
        return done

    def expect_unharmed(self, sim):
        counters = sim.end().told
        for device in counters:
            self.assertEqual((device['writes'], device['resets'], device['resets_refused']), (0, 0, 0),
                             device)
        return counters

    def expect_unasked(self, sim):
        counters, = sim.end().told
        self.assertEqual((counters['requests'], counters['crc_errors'], counters['others']), (0, 0, 0))
        return counters


class Eight(Case):
    @e2e.each(
        eight_sensors_of_three_models_are_found_and_none_is_harmed=EIGHT,
        eight_sensors_are_found_behind_local_echo_although_two_are_noisy=EIGHT.replace(
            'a16:2:modbus', 'a16:2:modbus,fault=noise').replace('s:7', 's:7,fault=noise=50%') + ' --echo')
    def eight(self, sensors):
        """Address 4 is the dead one."""
        sim = self.sim(f'{sensors} --counters')
        self.scan(sim, f'--address 1-9 {PATIENT}',
                  '3 HPS-167S have their termination resistor on, as from the factory, which overloads the '
                  'line',
                  f'as fathom set hps167s:ADDRESS --port {sim} termination off does',
                  'fathom: sensors found: 8, after ')
        self.assertEqual({one['address']: one['model'] for one in self.found}, FOUND)
        self.assertEqual(len(self.found), 8)
        for one in self.found:
            line = (19200, 'even') if one['model'] == 'hps167s' else (9600, 'none')
            self.assertEqual((one['kind'], one['baud'], one['parity'], one['mode']),
                             ('sensor', *line, 'modbus'))
        counters = self.expect_unharmed(sim)
        self.assertEqual(len(counters), 8)
        self.assertTrue(all(device['requests'] >= 3 for device in counters), counters)


class Output(Case):
    def test_what_is_printed_as_next_reads_the_sensor(self):
        sim = self.sim('a16:11:modbus a05:12:modbus hps167s:13,baud=57600 --distance 1234')
        self.scan(sim, f'--address 11-13 --baud 9600,57600 {PATIENT}')
        self.assertEqual([one['model'] for one in self.found], ['a16', 'a05', 'hps167s'])
        for one in self.found:
            self.assertTrue(one['next'].startswith(f'fathom read {one["model"]} '))
            samples = self.read_json(one['next'][12:], '--count 1 --timeout 5000')
            self.assertEqual(samples[0]['distance_mm'], 1234)
        self.assertEqual([one.get('raw') for one in self.found], [1234, 1234, None])
        # HPS-167S #3: the example; #1 is the simulator's own
        expected = {'sensor_version': '3.9', 'sensor_date': '2019-09-23', 'termination': True, 'baud': 57600,
                    'uuid': '00390025423457142034383501060705', 'address': 13}
        self.assertEqual({name: self.found[2][name] for name in expected}, expected)

    def test_a_line_of_text_has_model_address_settings_what_it_told_and_what_to_type(self):
        sim = self.sim(['hps167s:7', '--link', self.path("it's here")])
        done = self.ends(['scan', '--port', self.path("it's here"),
                          *f'--address 7 --baud 19200 {PATIENT}'.split()], 0)
        self.assertEqual(len(done.out.splitlines()), 1)
        self.assertRegex(done.out, r'^hps167s +address 7 +19200 8E1 +interface 2\.1\.0 of 2020-09-27, '
                                   r'sensor 3\.9 of '
                                   r'2019-09-23, termination on +->  fathom read hps167s --address 7 --port ')
        words = shlex.split(done.out.split('->')[1])
        self.assertEqual(words[-1], self.path("it's here"))
        self.assertNotIn('overloads', done.err)  # one alone does not
        self.assertNotIn('\r', done.out + done.err)
        self.assertEqual(self.read_json(words[2:], '--count 1')[0]['address'], 7)
        self.expect_unharmed(sim)

    def test_how_long_it_takes_is_said_before_it_begins(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --address 1-2')
        program.expect(r'^fathom: asks addresses 1 to 2 at 9600 8N1, 19200 8E1; takes about \d+ s, '
                       'and a second for each sensor$', 'err')
        self.assertTrue(device.is_silent(1))  # it listens
        self.assertEqual(device.baud(), termios.B9600)
        device.asked(e2e.adu(1, 3, 2, 0, 0, 1))  # A16 6: the address register, which measures nothing
        self.ends(program, 1)

    def test_on_a_terminal_there_is_a_bar_that_goes_away(self):
        sim = self.sim('hps167s:2')
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        attributes = termios.tcgetattr(slave)
        attributes[1] &= ~termios.OPOST
        termios.tcsetattr(slave, termios.TCSANOW, attributes)
        program = self.fathom(f'scan --port {sim} --address 1-4 {PATIENT}', stderr=slave)
        os.close(slave)
        said = b''
        while e2e.is_ready(master, e2e.PATIENCE):
            try:
                said += os.read(master, 4096)
            except OSError:  # the last writer has gone
                break
        done = program.finish()
        self.assertEqual(done.code, 0, said)
        self.assertNotIn('\r', done.out)
        self.assertEqual(len(done.out.splitlines()), 1)
        bars = re.findall(rb'\r\[([#.]{24})\] +(\d+) %  ([^\r]*?), (\d+) s left\x1b\[K', said)
        self.assertGreater(len(bars), 5)
        self.assertEqual(bars[0][2], b'listens')
        self.assertRegex(bars[-1][2], rb'^(9600 8N1|19200 8E1) address \d$')
        self.assertEqual([int(bar[1]) for bar in bars], sorted(int(bar[1]) for bar in bars))
        for filled, percent, _, _ in bars:
            self.assertEqual(filled.count(b'#'), int(percent) * 24 // 100)
        shown = said.decode().split('\x1b[K')[-1]
        self.assertRegex(shown, r'^fathom: sensors found: 1, after \d+ s\n$')


class Estimate(Case):
    def seconds(self, options=''):
        done = self.run_fathom(f'scan --estimate --format json {options}')
        self.assertEqual((done.code, done.err), (0, ''))
        return done.json[0]

    def test_all_addresses_rates_and_parities_are_said_to_take_less_than_ten_minutes(self):
        told = self.seconds('--address 1-254 --baud all --parity all')
        self.assertEqual((told['settings'], told['addresses']), (15, 254))
        # each time-out is at least 100 ms
        self.assertTrue(15 * 254 * 0.1 < told['seconds'] < 600, told)

    def test_the_default_is_32_addresses_at_the_factory_settings_and_needs_no_port(self):
        told = self.seconds()
        self.assertEqual((told['settings'], told['addresses']), (2, 32))
        self.assertEqual(told['seconds'], 18)  # 8 + 32 * (0.163 + 0.110) + 0.755 is 17.5
        self.ends('scan --estimate', 0,
                  out='addresses 1 to 32 at 9600 8N1, 19200 8E1: about 18 s, and a second for '
                                            'each sensor\n')

    def test_time_outs_and_retries_are_in_it(self):
        asked = '--address 5 --baud 19200 --timeout 2000 --listen 4'
        self.assertEqual(self.seconds(asked)['seconds'], 7)
        self.assertEqual(self.seconds(asked + ' --retries 1')['seconds'], 11)

    def test_a_line_without_sensors_takes_no_less(self):
        # 1 + 2 * (0.5 + 0.5) + 0.5 + 0.3 s: the time-outs alone, and that for any A05
        self.assertGreater(self.ends(f'scan --port {self.device()} --address 1-2 {PATIENT}', 1).elapsed, 3.8)

    @e2e.each(**{f'lists_are_taken_as_they_are_meant_{number}': row for number, row in enumerate((
        ('--baud 57600,9600,57600', '57600 8E1, 9600 8N1'),
        ('--parity odd,none', '9600 8N1, 9600 8O1, 19200 8N1, 19200 8O1'),
        ('--baud 38400 --parity all', '38400 8E1, 38400 8N1, 38400 8O1'),
        ('--stop-bits 2', '9600 8N2, 19200 8N2'),
        ('--baud 19200 --parity even,none --stop-bits 2', '19200 8E2, 19200 8N2'),
        ('--baud all', '9600 8N1, 19200 8E1, 57600 8E1, 115200 8E1, 230400 8E1')))})
    def lists(self, options, settings):
        done = self.run_fathom(f'scan --estimate --address 7 {options}')
        self.assertRegex(done.out, f'^address 7 at {settings}: about ')


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
                  'nothing was sent, because requests would go into what it sends; --wake')
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
        self.scan(self.sim('hps167s:20 --echo'), f'--address 1-2 {PATIENT}',
                  "only the tool's own requests came back", code=1)

    def test_two_with_one_address_are_told(self):
        sim = self.sim('hps167s:3 hps167s:3 hps167s:4 --counters')
        self.scan(sim, f'--address 2-4 --baud 19200 {PATIENT}',
                  'responses at address 3 (19200 8E1) are damaged: two sensors with one address?')
        self.assertEqual({one['address']: one['kind'] for one in self.found}, {3: 'damaged', 4: 'sensor'})
        self.expect_unharmed(sim)

    @e2e.each(
        responses_that_are_no_modbus_are_told_with_the_older_units=(
            lambda request: b'\x55\x80\x04\x71\x99', '--timeout 200', ('not_modbus', None, None),
            'something answers at 19200 8E1, but not Modbus: an HPS-167S made before 2020-09'),
        a_device_that_refuses_everything_is_another_modbus_device=(
            lambda request: e2e.adu(request[0], 0x83, 2) if request[0] == 2 else b'', '',
            ('other_modbus', None, 2)))
    def answered(self, response, options, found, *said):
        """Every request is answered so until the scan ends."""
        device = self.device()
        program = self.fathom(f'scan --port {device} --format json {PATIENT} --address 1-3 --baud 19200 '
                              f'{options}')
        while not program.has_ended():
            if not device.is_silent(0.02):
                device.write(response(device.read(8)))
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
        program = self.fathom(f'scan --port {self.sim("hps167s:1")} --baud 19200 --address 1-254 {PATIENT}')
        program.expect('^hps167s +address 1 ')
        self.ends(program.end(signal.SIGINT), 0, 'ended before all addresses were asked; sensors found: 1')

    def test_a_reader_that_has_seen_enough_ends_it(self):
        sim = self.sim('hps167s:1 hps167s:2')
        out, pipe = os.pipe()
        program = self.fathom(f'scan --port {sim} --baud 19200 --address 1-254 {PATIENT}', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            self.assertIn('address 1 ', stdout.readline())
        self.ends(program, 1)  # in 20 s, and all addresses take 2 minutes


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
