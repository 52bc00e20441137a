#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom scan as a program: what it finds and prints, that it harms nobody, and what it advises. How it judges what
it hears, and how long it takes, is in tests/sim/test_scan*.c, in simulated time."""
import json
import os
import pty
import re
import select
import shlex
import termios

import e2e
from scanning import PATIENT, Case

EIGHT = ['a16:1:modbus', 'a16:2:modbus', 'a05:3:modbus', 'a05:5:dyp', 'hps167s:6', 'hps167s:7', 'hps167s:8',
         'a16:9:modbus']
FOUND = {1: 'a16', 2: 'a16', 3: 'a05', 5: 'a05', 6: 'hps167s', 7: 'hps167s', 8: 'hps167s', 9: 'a16'}


class Eight(Case):
    """Address 4 is the dead one."""

    def check(self, *arguments):
        sim = self.sim(*EIGHT, '--counters', *arguments)
        done = self.scan(sim.port, '--address', '1-9', *PATIENT)
        self.assertEqual({one['address']: one['model'] for one in self.found}, FOUND)
        self.assertEqual(len(self.found), 8)
        for one in self.found:
            is_hps = one['model'] == 'hps167s'
            self.assertEqual((one['kind'], one['baud'], one['parity'], one['mode']),
                             ('sensor', 19200 if is_hps else 9600, 'even' if is_hps else 'none', 'modbus'))
        counters = self.expect_unharmed(sim)
        self.assertEqual(len(counters), 8)
        self.assertTrue(all(device['requests'] >= 3 for device in counters), counters)
        self.assertIn('3 HPS-167S have their termination resistor on, as from the factory, which overloads the line',
                      done.err)
        self.assertIn(f'as fathom set hps167s:ADDRESS --port {sim.port} termination off does', done.err)
        self.assertIn('fathom: sensors found: 8, after ', done.err)

    def test_eight_sensors_of_three_models_are_found_and_none_is_harmed(self):
        self.check()

    def test_they_are_found_behind_local_echo_with_one_that_is_noisy(self):
        self.check('--echo', '--fault', '2@noise', '--fault', '6@noise=50%')


class Output(Case):
    def test_what_is_printed_as_next_reads_the_sensor(self):
        sim = self.sim('a16:11:modbus', 'a05:12:modbus', 'hps167s:13', '--baud', '3@57600', '--distance', '1234')
        self.scan(sim.port, '--address', '11-13', '--baud', '9600,57600', *PATIENT)
        self.assertEqual([one['model'] for one in self.found], ['a16', 'a05', 'hps167s'])
        for one in self.found:
            words = shlex.split(one['next'])
            self.assertEqual(words[:3], ['fathom', 'read', one['model']])
            samples = self.read_json(*words[2:], '--count', 1, '--timeout', 5000)
            self.assertEqual(samples[0]['distance_mm'], 1234)
        self.assertEqual([one.get('raw') for one in self.found], [1234, 1234, None])
        # HPS-167S #3: the example; #1 is the simulator's own
        self.assertEqual({name: self.found[2][name] for name in ('sensor_version', 'sensor_date', 'uuid', 'termination',
                                                                 'baud', 'address')},
                         {'sensor_version': '3.9', 'sensor_date': '2019-09-23', 'termination': True, 'baud': 57600,
                          'uuid': '00390025423457142034383501060705', 'address': 13})

    def test_a_line_of_text_has_model_address_settings_what_it_told_and_what_to_type(self):
        sim = self.sim('hps167s:7', '--link', self.path("it's here"))
        done = self.run_fathom('scan', '--port', self.path("it's here"), '--address', 7, '--baud', 19200, *PATIENT)
        self.assertEqual(done.code, 0, done.err)
        self.assertEqual(len(done.out.splitlines()), 1)
        self.assertRegex(done.out, r'^hps167s +address 7 +19200 8E1 +interface 2\.1\.0 of 2020-09-27, sensor 3\.9 of '
                                   r'2019-09-23, termination on +->  fathom read hps167s --address 7 --port ')
        words = shlex.split(done.out.split('->')[1])
        self.assertEqual(words[-1], self.path("it's here"))
        self.assertNotIn('overloads', done.err)  # one alone does not
        self.assertNotIn('\r', done.out + done.err)
        self.assertEqual(self.read_json(*words[2:], '--count', 1)[0]['address'], 7)
        self.expect_unharmed(sim)

    def test_how_long_it_takes_is_said_before_it_begins(self):
        device = self.device()
        program = self.fathom('scan', '--port', device.path, '--address', '1-2')
        program.expect(r'^fathom: asks addresses 1 to 2 at 9600 8N1, 19200 8E1; takes about \d+ s, '
                       'and a second for each sensor$', 'err')
        self.assertTrue(device.is_silent(1))  # it listens
        self.assertEqual(device.baud(), termios.B9600)
        self.assertEqual(device.read(8), e2e.adu(1, 3, 2, 0, 0, 1))  # A16 6: the address register, which measures nothing
        self.assertEqual(program.finish().code, 1)

    def test_on_a_terminal_there_is_a_bar_that_goes_away(self):
        sim = self.sim('hps167s:2')
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        attributes = termios.tcgetattr(slave)
        attributes[1] &= ~termios.OPOST
        termios.tcsetattr(slave, termios.TCSANOW, attributes)
        process = e2e.subprocess.Popen([e2e.FATHOM, 'scan', '--port', sim.port, '--address', '1-4', '--listen', '1'],
                                       stdin=e2e.subprocess.DEVNULL, stdout=e2e.subprocess.PIPE, stderr=slave)
        os.close(slave)
        said = b''
        while True:
            self.assertTrue(select.select([master], [], [], e2e.PATIENCE)[0])
            try:
                piece = os.read(master, 4096)
            except OSError:  # the last writer has gone
                break
            if not piece:
                break
            said += piece
        out = process.communicate(timeout=e2e.PATIENCE)[0].decode()
        self.assertEqual(process.returncode, 0, said)
        self.assertNotIn('\r', out)
        self.assertEqual(len(out.splitlines()), 1)
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
    def seconds(self, *arguments):
        done = self.run_fathom('scan', '--estimate', '--format', 'json', *arguments)
        self.assertEqual((done.code, done.err), (0, ''))
        return json.loads(done.out)

    def test_all_addresses_rates_and_parities_are_said_to_take_less_than_ten_minutes(self):
        told = self.seconds('--address', '1-254', '--baud', 'all', '--parity', 'all')
        self.assertEqual((told['settings'], told['addresses']), (15, 254))
        # each time-out is at least 100 ms
        self.assertTrue(15 * 254 * 0.1 < told['seconds'] < 600, told)

    def test_the_default_is_32_addresses_at_the_factory_settings_and_needs_no_port(self):
        told = self.seconds()
        self.assertEqual((told['settings'], told['addresses']), (2, 32))
        self.assertEqual(told['seconds'], 13)  # 3 + 32 * (0.163 + 0.110) + 0.755 is 12.5
        done = self.run_fathom('scan', '--estimate')
        self.assertEqual(done.out, 'addresses 1 to 32 at 9600 8N1, 19200 8E1: about 13 s, and a second for each sensor\n')

    def test_time_outs_and_retries_are_in_it(self):
        self.assertEqual(self.seconds('--address', '5', '--baud', '19200', '--timeout', '2000', '--listen', '4')['seconds'], 7)
        self.assertEqual(self.seconds('--address', '5', '--baud', '19200', '--timeout', '2000', '--listen', '4',
                                      '--retries', '1')['seconds'], 11)

    def test_a_line_without_sensors_takes_no_less(self):
        # 1 + 2 * (0.5 + 0.5) + 0.5 + 0.3 s: the time-outs alone, and that for any A05
        done = self.run_fathom('scan', '--port', self.device().path, '--address', '1-2', *PATIENT)
        self.assertEqual(done.code, 1)
        self.assertGreater(done.elapsed, 3.8)


class Usage(Case):
    WRONG = [
        ([], '--port is missing'),
        (['--port', 'tcp:127.0.0.1'], "it needs a serial port; the rates behind 'tcp:127.0.0.1' are the gateway's"),
        (['a16'], "it takes options only, not 'a16'"),
        (['--address', '0'], "--address takes one from 1 to 254, or a range such as 1-32, not '0'"),
        (['--address', '255'], "not '255'"),
        (['--address', '1-255'], "not '1-255'"),
        (['--address', '9-8'], "not '9-8'"),
        (['--address', '1-'], "not '1-'"),
        (['--address', '-5'], "not '-5'"),
        (['--address', '1-5-9'], "not '1-5-9'"),
        (['--address', ''], "not ''"),
        (['--baud', '4800'], "and 230400 with commas between them, not '4800'"),
        (['--baud', '9600,'], "not ''"),
        (['--baud', ',9600'], "not ''"),
        (['--baud', '9600 '], "not '9600 '"),
        (['--baud', 'All'], "not 'All'"),
        (['--parity', 'mark'], "--parity takes all, or some of none, even and odd with commas between them, not 'mark'"),
        (['--parity', 'none,'], "not ''"),
        (['--timeout', '0'], '--timeout takes a whole number from 1 to 10000'),
        (['--retries', '10'], '--retries takes a whole number from 0 to 9'),
        (['--listen', '0'], '--listen takes a whole number from 1 to 60'),
        (['--format', 'csv'], "there is no format 'csv', only text, json"),
        (['--fast'], 'there is no option --fast'),
    ]

    def test_wrong_usage_is_2_and_one_line(self):
        for arguments, words in self.WRONG:
            with self.subTest(arguments):
                port = ['--port', '/nowhere'] if arguments else []
                done = self.run_fathom('scan', *port, *arguments)
                self.assertEqual((done.code, done.out, len(done.err.splitlines())), (2, '', 1), done.err)
                self.assertIn(words, done.err)
                self.assertTrue(done.err.endswith('; try: fathom scan --help\n'), done.err)

    def test_lists_are_taken_as_they_are_meant(self):
        for arguments, settings in (
                (['--baud', '57600,9600,57600'], '57600 8E1, 9600 8N1'),
                (['--parity', 'odd,none'], '9600 8N1, 9600 8O1, 19200 8N1, 19200 8O1'),
                (['--baud', '38400', '--parity', 'all'], '38400 8E1, 38400 8N1, 38400 8O1'),
                (['--baud', 'all'], '9600 8N1, 19200 8E1, 57600 8E1, 115200 8E1, 230400 8E1')):
            with self.subTest(arguments):
                done = self.run_fathom('scan', '--estimate', '--address', '7', *arguments)
                self.assertRegex(done.out, f'^address 7 at {settings}: about ')

    def test_the_help_names_every_option_and_its_examples_are_right_usage(self):
        done = self.run_fathom('scan', '--help')
        self.assertEqual((done.code, done.err), (0, ''))
        self.assertTrue(all(len(line) < 125 for line in done.out.splitlines()))
        for word in ('--port', '--address', '--baud', '--parity', '--timeout', '--retries', '--listen', '--wake', '--estimate',
                     '--format', 'Exit status', 'examples:'):
            self.assertIn(word, done.out)
        examples = re.findall(r'(fathom scan --port (?:(?! {2}).)*)', done.out.split('examples:')[1])
        self.assertEqual(len(examples), 3)
        for example in examples:
            words = example.replace('/dev/ttyUSB0', '/nowhere').split()[1:]
            self.assertEqual(self.run_fathom(*words).code, 1)
        self.assertIn('\n  scan ', self.run_fathom('--help').out)


if __name__ == '__main__':
    e2e.main()
