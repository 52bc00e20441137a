#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Help, version, and wrong usage: exit status 2 and one line that says what and where help is."""
import re

import e2e

READ = ['read', 'a16', '--port', '/nowhere']

# arguments, what the line must have
WRONG = [
    ([], 'a command is missing: scan, read, watch, '),
    (['reed'], "there is no command 'reed'"),
    (['--versoin'], "there is no command '--versoin'"),
    (['read'], 'which sensor? a16, a05 or hps167s'),
    (['read', '--port', '/nowhere'], 'which sensor?'),
    (['read', 'a17', '--port', '/nowhere'], "there is no sensor 'a17', only a16, a05, hps167s"),
    (['read', 'a17:1', '--port', '/nowhere'], "there is no sensor 'a17', only a16, a05, hps167s"),
    (['read', 'a16' * 30, '--port', '/nowhere'], "there is no sensor 'a16a16"),
    (['read', '', '--port', '/nowhere'], "there is no sensor ''"),
    (['read', 'a16'], '--port is missing'),
    ([*READ, '--mode', 'dyp'], "there is no mode 'dyp' for a16, only auto, modbus"),
    (['read', 'hps167s', '--port', '/nowhere', '--mode', 'auto'], "there is no mode 'auto' for hps167s, only modbus"),
    ([*READ, '--format', 'xml'], "there is no format 'xml', only text, json, csv"),
    ([*READ, '--parity', 'mark'], "--parity takes none, even or odd, not 'mark'"),
    ([*READ, '--parity', 'Even'], "not 'Even'"),
    ([*READ, '--baud', '12345'], '--baud takes 9600, 19200,'),
    ([*READ, '--baud', '9600x'], "not '9600x'"),
    ([*READ, '--baud', ''], "not ''"),
    ([*READ, '--count', '0'], '--count takes a whole number from 1 to 1000000000'),
    ([*READ, '--count', '-1'], "not '-1'"),
    ([*READ, '--count', '+1'], "not '+1'"),
    ([*READ, '--count', '1e3'], "not '1e3'"),
    ([*READ, '--count', '0x10'], "not '0x10'"),
    ([*READ, '--count', ' 1'], "not ' 1'"),
    ([*READ, '--count', '1 '], "not '1 '"),
    ([*READ, '--count', ''], "not ''"),
    ([*READ, '--count', '1000000001'], "not '1000000001'"),
    ([*READ, '--count', '4294967297'], "not '4294967297'"),
    ([*READ, '--count', '18446744073709551617'], "not '18446744073709551617'"),
    ([*READ, '--address', '0'], '--address takes a whole number from 1 to 254'),
    ([*READ, '--address', '255'], "not '255'"),
    (['read', 'hps167s', '--port', '/nowhere', '--address', '33'], 'from 1 to 32'),
    ([*READ, '--interval', '3600001'], '--interval takes a whole number from 0 to 3600000'),
    ([*READ, '--timeout', '0'], '--timeout takes a whole number from 1 to 600000'),
    ([*READ, '--timeout', '600001'], "not '600001'"),
    ([*READ, '--retries', '255'], '--retries takes a whole number from 0 to 254'),
    ([*READ, '--echo', 'yes'], "--echo takes auto, on or off, not 'yes'"),
    ([*READ, '--echo', ''], "not ''"),
    ([*READ, '--stats=0'], '--stats takes a whole number from 1 to 4000'),
    ([*READ, '--stats=1s'], "not '1s'"),
    ([*READ, '--stats', '5'], "there is no sensor '5'"),
    ([*READ, '--reconnect=1'], 'there is no option --reconnect=1'),
    ([*READ, '--fast'], 'there is no option --fast'),
    ([*READ, '-p'], 'there is no option -p'),
    ([*READ, '--help=3'], 'there is no option --help=3'),
    (['read', 'a16', '--port'], '--port needs a value'),
    (['sim'], 'which sensor?'),
    (['sim', 'a16', 'a05'], 'a16 and a05 would both send by themselves'),
    (['sim', 'a17'], "there is no sensor 'a17'"),
    (['sim', 'a16' * 30], "there is no sensor 'a16a16"),
    (['sim', 'a16:0'], "the address of a16 is a number from 1 to 254, not '0'"),
    (['sim', 'a16:255'], "not '255'"),
    (['sim', 'a16:1x'], "not '1x'"),
    (['sim', 'hps167s:33'], 'from 1 to 32'),
    (['sim', 'a16:1:pwm'], "there is no mode 'pwm' for a16, only auto, modbus"),
    (['sim', 'a16:1:auto:1'], "there is no mode 'auto:1'"),
    (['sim', 'a16:1:'], "there is no mode ''"),
    (['sim', 'a16', '--distance', '1000,2000'], "--distance '1000,2000' is more than the 1 of a16"),
    (['sim', 'a05', '--distance', '1,2,3,4,5'], 'more than the 4 of a05'),
    (['sim', 'a16', '--distance', '65536'], "--distance takes 0..65535 mm, no-target or interference, not '65536'"),
    (['sim', 'a16', '--distance', '-1'], "not '-1'"),
    (['sim', 'a16', '--distance', ''], "not ''"),
    (['sim', 'a05', '--distance', '1000,'], "not ''"),
    (['sim', 'a05', '--distance', ',1000'], "not ''"),
    (['sim', 'a16', '--distance', 'fault'], "not 'fault'"),
    (['sim', 'hps167s', '--distance', 'interference'], 'no-target or fault'),
    (['sim', 'a16', '--distance', '1' * 40], f"not '{'1' * 40}'"),
    (['sim', 'a16', '--seed', '4294967296'], '--seed takes a whole number from 0 to 4294967295'),
    (['sim', 'a16', '--port', '/nowhere'], 'there is no option --port'),
]


class Wrong(e2e.Case):
    def check(self, arguments, words):
        done = self.run_fathom(*arguments)
        self.assertEqual((done.code, done.out), (2, ''), done.err)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        self.assertIn(words, done.err)
        command = arguments[0] + ' ' if arguments and arguments[0] in ('read', 'sim') else ''
        self.assertTrue(done.err.endswith(f'; try: fathom {command}--help\n'), done.err)


def add(number, arguments, words):
    name = re.sub('[^a-z0-9]+', '_', '_'.join(arguments).lower())[:50]
    setattr(Wrong, f'test_{number:02}_{name}', lambda self: self.check(arguments, words))


for row in enumerate(WRONG):
    add(row[0], *row[1])


class Help(e2e.Case):
    def told(self, *arguments):
        done = self.run_fathom(*arguments)
        self.assertEqual((done.code, done.err), (0, ''))
        self.assertTrue(all(len(line) < 125 for line in done.out.splitlines()))
        return done.out

    def test_the_version_is_that_of_the_library(self):
        with open(f'{e2e.ROOT}/include/fathom/version.h', encoding='ascii') as file:
            version = re.search('VERSION_STRING "(.*)"', file.read())[1]
        self.assertEqual(self.told('--version'), f'fathom {version}\n')

    def test_help_names_every_command(self):
        for word in ('--help', '-h'):
            self.assertRegex(self.told(word), r'(?s)\n  read .*\n  watch .*\n  sim .*Exit status')

    def test_help_of_read_names_sensors_options_and_examples(self):
        text = self.told('read', '--help')
        for word in ('a16', 'a05', 'hps167s', '19200 8E1', '--port', '--mode', '--address', '--baud', '--parity', '--count',
                     '--interval', '--timeout', '--retries', '--format', '--reconnect', '--echo', '--stats[=SECONDS]', 'Exit status', 'examples:'):
            self.assertIn(word, text)

    def test_help_of_sim_names_sensors_options_and_examples(self):
        text = self.told('sim', '--help')
        for word in ('a16', 'a05', 'hps167s', '--link', '--distance', '--seed', 'Exit status', 'examples'):
            self.assertIn(word, text)

    def test_help_wins_over_what_is_missing(self):
        self.assertEqual(self.told('read', 'a17', '--help'), self.told('read', '--help'))

    def test_each_example_of_the_help_is_right_usage(self):
        """Each is run with the port replaced by one that is not there: then 1, not 2, is the exit status."""
        examples = re.findall(r'(fathom read (?:(?! {2}|\||>).)*)', self.told('read', '--help').split('examples:')[1] +
                              self.told('sim', '--help').split('examples')[1])
        self.assertEqual(len(examples), 9)
        for example in examples:
            with self.subTest(example):
                words = re.sub(r'--port \S+', '--port /nowhere', example).split()[1:]
                self.assertEqual(self.run_fathom(*words).code, 1)

    def test_options_may_stand_before_and_after_the_sensor_and_the_last_one_counts(self):
        done = self.run_fathom('read', '--format', 'csv', 'a16', '--port', '/elsewhere', '--port', '/nowhere')
        self.assertEqual(done.code, 1)
        self.assertIn('/nowhere: no such device', done.err)

    def test_what_has_no_effect_is_said(self):
        done = self.run_fathom(*READ, '--address', '7')
        self.assertIn('in mode auto nothing is asked, so --address has no effect\n', done.err)
        done = self.run_fathom(*READ, '--retries', '7')
        self.assertIn('in mode auto nothing is asked, so --retries has no effect\n', done.err)
        done = self.run_fathom(*READ, '--echo', 'on')
        self.assertIn('in mode auto nothing is asked, so --echo has no effect\n', done.err)
        self.assertNotIn('no effect', self.run_fathom(*READ, '--mode', 'modbus', '--retries', '7').err)


if __name__ == '__main__':
    e2e.main()
