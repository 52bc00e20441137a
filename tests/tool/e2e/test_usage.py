#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Help, version, and wrong usage: exit status 2 and one line that says what and where help is, before
anything is sent."""
import re

import e2e

COUNTED = '1 to 1000000000'


def told(option, *texts):
    """Each of these is no value of it."""
    return [(f"{option} '{text}'", f"not '{text}'") for text in texts]


# What is promised; what a line begins with; how it may go on, and what is said then.
WRONG = [
    ('wrong_usage', '', [
        ('', 'a command is missing: scan, read, watch, '),
        ('reed', "there is no command 'reed'"),
        ('--versoin', "there is no command '--versoin'"),
    ]),
    ('wrong_usage', 'read', [
        ('', 'which sensor? a16, a05 or hps167s'),
        ('--port /nowhere', 'which sensor?'),
        ('a17 --port /nowhere', "there is no sensor 'a17', only a16, a05, hps167s"),
        ('a17:1 --port /nowhere', "there is no sensor 'a17', only a16, a05, hps167s"),
        ('a16' * 30 + ' --port /nowhere', "there is no sensor 'a16a16"),
        ("'' --port /nowhere", "there is no sensor ''"),
        ('a16', '--port is missing'),
        ('a16 --port', '--port needs a value'),
        ('hps167s --port /nowhere --mode dyp', "there is no mode 'dyp' for hps167s, only modbus, auto"),
        ('hps167s --port /nowhere --address 33', 'from 1 to 32'),
    ]),
    ('wrong_usage', 'read a16 --port /nowhere', [
        ('--mode dyp', "there is no mode 'dyp' for a16, only auto, modbus"),
        ('--format xml', "there is no format 'xml', only text, json, csv"),
        ('--parity mark', "--parity takes none, even or odd, not 'mark'"),
        *told('--parity', 'Even'),
        ('--stop-bits 3', '--stop-bits takes a whole number from 1 to 2'),
        ('--baud 12345', '--baud takes 9600, 19200,'),
        *told('--baud', '9600x', ''),
        ('--count 0', f'--count takes a whole number from {COUNTED}'),
        *told('--count', '-1', '+1', '1e3', '0x10', ' 1', '1 ', '', '1000000001', '4294967297',
              '18446744073709551617'),
        ('--duration 0', f'--duration takes a whole number from {COUNTED}'),
        ('--address 0', '--address takes a whole number from 1 to 254'),
        *told('--address', '255'),
        ('--interval 2147484', '--interval takes a whole number from 0 to 2147483'),
        ('--timeout 0', '--timeout takes a whole number from 1 to 600000'),
        *told('--timeout', '600001'),
        ('--retries 255', '--retries takes a whole number from 0 to 254'),
        ('--echo yes', "--echo takes auto, on or off, not 'yes'"),
        ("--echo ''", "not ''"),
        ('--stats=0', '--stats takes a whole number from 1 to 4000'),
        ('--stats=1s', "not '1s'"),
        ('--stats 5', "there is no sensor '5'"),
        ('--reconnect=1', 'there is no option --reconnect=1'),
        ('--fast', 'there is no option --fast'),
        ('-x', 'there is no option -x'),
        ('-p', '-p needs a value'),
        ('--no-header', '--no-header is for --format csv'),
        ('--rotate day', '--rotate takes --output too'),
        ('--output log.csv --rotate hour', "--rotate takes day, not 'hour'"),
        ("--output ''", '--output takes the name of a file'),
        ('--help=3', 'there is no option --help=3'),
    ]),
    ('what_cannot_be_is_said_before_anything_is_sent', 'read --port /nowhere', [
        ('a16 a05:2:auto',
         'a05 in mode auto sends by itself and cannot share a line with others; ask it, such as '
                           'a05:2:modbus'),
        ('a16:1:modbus a16:1:modbus', 'a16:1 and a16:1 have the same address, so both would answer at once'),
        ('a16:1 a05:1', 'a16:1 and a05:1 have the same address'),
        ('a05:1:modbus a05:2:dyp',
         'a damaged response in mode dyp can change the address of another a05 on the line; '
                                   'ask them all by Modbus, such as a05:2:modbus'),
        ('a16:1 a05:2 --address 5', 'with several sensors --address and --mode stand behind each name'),
        ('a16:1 a05:2 --mode modbus', 'with several sensors --address and --mode stand behind each name'),
        ('a16:1 --address 5', "'a16:1' and an option say the same; leave one of them out"),
        ('a16:1:modbus --mode auto', "'a16:1:modbus' and an option say the same"),
        ('a16:0:auto', "the address of a16 is a number from 1 to 254, not '0'"),
        ('a05:0:dyp', "the address of a05 is a number from 1 to 254, not '0'"),
        ('a05:255:modbus', "the address of a05 is a number from 0 to 254, not '255'"),
        ('hps167s:0', "the address of hps167s is a number from 1 to 32, not '0'"),
        ('hps167s:33', "the address of hps167s is a number from 1 to 32, not '33'"),
        ('a16:1:dyp', "there is no mode 'dyp' for a16, only auto, modbus"),
        ('a16:1:', "there is no mode '' for a16"),
        (' '.join(f'a16:{address}' for address in range(1, 34)), 'a line has 32 sensors at most'),
    ]),
    ('wrong_usage_of_watch', 'watch', [
        ('', 'which sensor?'),
        ('a16', '--port is missing'),
        ('a17 --port /nowhere', "there is no sensor 'a17'"),
        ('a16 --count 3', 'there is no option --count'),
        ('a16 --duration 1s --port /nowhere', '--duration takes a whole number'),
        ('a05 --probes 5 --port /nowhere', "--probes takes some of 1,2,3,4, each once, not '5'"),
        ('a16 --means 0 --port /nowhere', "not '0'"),
    ]),
    ('a_port_of_each_sensor', 'read', [
        ('a16@', 'a16@: the port is missing behind @, such as @/dev/ttyUSB0'),
        ('a16@,baud=9600', 'the port is missing behind @'),
        ('a16:pwm', 'the GPIO lines are missing; they stand behind the sensor: a16:pwm@gpiochip0,trigger=17,echo=27'),
        ('a05:relay', 'behind the sensor: a05:relay@gpiochip0,in=5'),
        ('hps167s --port /nowhere,baud=57600',
         '--port takes no keys; they stand behind the sensor: hps167s@/nowhere,baud=57600'),
        ('a16:switch -p gpiochip0,in=6', 'they stand behind the sensor: a16:switch@gpiochip0,in=6'),
        ('a16@/nowhere a05:2', '--port is missing, such as --port /dev/ttyUSB0; or behind the sensor: '
                               'a05:2@/dev/ttyUSB0'),
        ('a16 --port /nowhere --port /elsewhere', '--port stands twice, and takes one'),
        ('a16@/nowhere,speed=1',
         "a16@/nowhere,speed=1: a serial port has no key 'speed', only baud, parity, stop, rs485, echo"),
        ('a16@/nowhere,trigger=1', "a serial port has no key 'trigger', only baud"),
        ('a16@gpiochip0,baud=9600', "a GPIO chip has no key 'baud', only trigger, echo, in, bias, near"),
        ('a16@/nowhere,', "a serial port has no key ''"),
        ('a16@/nowhere,baud', 'a16@/nowhere,baud: the value of baud is missing: 9600, 19200,'),
        ('a16@/nowhere,baud=', "baud takes 9600, 19200, 38400, 57600, 115200 or 230400, not ''"),
        ('a16@/nowhere,baud=9600,baud=9600', 'baud stands there twice'),
        ('a16@/nowhere,stop=3', "stop takes a whole number from 1 to 2, not '3'"),
        ('a16@/nowhere,echo=7', "echo takes auto, on or off, not '7'"),
        ('a16@gpiochip0,echo=on', "echo takes the number of a line from 0 to 65535, not 'on'"),
        ('a16@gpiochip0,bias=high', "bias takes as-is, up, down or off, not 'high'"),
        ('hps167s@tcp:h,baud=9600', "a port over TCP has no keys, for the line is the gateway's"),
        ('hps167s@tcp:', 'tcp:: the host is missing'),
        ('a16@tcp:h', 'a16 in mode auto needs a serial port; over tcp: a sensor is asked by Modbus: a16:modbus'),
        ('a16@/dev/gpiochip0,in=1', 'a16 in mode auto needs a serial port, and /dev/gpiochip0 is a GPIO chip'),
        ('a16:modbus@gpiochip0', 'a16 in mode modbus needs a serial port'),
        ('a16@gpiochip0,trigger=3,echo=3', 'line 3 of gpiochip0 stands for two things, trigger and echo'),
        ('a=a16@gpiochip0,in=3 b=a16@/dev/gpiochip0,echo=3', 'line 3 of gpiochip0 stands for two things'),
        ('a16:3@x,baud=9600 a16:4@x,baud=19200', 'a16:4@x: another sensor at this port has another baud'),
        ('=a16@x', "the first a letter or digit, such as tank-1=a16; not ''"),
        ('-- -a=a16@x', "not '-a'"),
        ('t/1=a16@x', "not 't/1'"),
        ('t' * 32 + '=a16@x', "a name has up to 31 letters, digits, - _ and ., the first a letter or digit"),
        ('t=a16@x t=a05@y', 'two sensors have the name t; give each one of its own, such as one=a05'),
        ('t=a16:1@x t=a05:2@x', 'two sensors have the name t'),
        ('a16@1/x a16@2/x', 'two sensors have the name a16@x'),
        ('a16@x a05:auto@x', 'a05 in mode auto sends by itself and cannot share a line'),
        ('a16:1@x a05:1 --port x', 'a16:1 and a05:1 have the same address'),
        ('a=a16:1@x b=a05:1@x', 'a and b have the same address'),
        ('a05:1:dyp@x a05:2@x', 'a damaged response in mode dyp'),
        (' '.join(f'a16:{address}@x' for address in range(1, 34)), 'a line has 32 sensors at most; x has 33'),
        ('a16@x ' * 257, 'up to 256 sensors at once, not 257'),
        ('a16:modbus@x --mode auto', "'a16:modbus@x' and an option say the same"),
        ('a16:modbus:1@x', "there is no mode 'modbus:1' for a16"),
    ]),
    ('probes_and_meanings_of_values', 'read', [
        *told('a05 --port /nowhere --probes', '0', '5', '1,', ',1', '1,1', '1-3', '', '1' * 40),
        ('a16:1 hps167s:2 --port /nowhere --probes 1',
         '--probes is for a05 (auto, modbus, dyp); it has no effect on a16 (modbus)'),
        *told('a16 --port /nowhere --means', '', '0', '0=', '0=far', '=unknown', '1=unknown', 'fffc=fault',
              '0=unknown,', '0=no-target=1', '0=' + 'x' * 40),
    ]),
    ('wrong_words_are_usage_errors', 'info', [
        ('a16:1:auto --port /nowhere', 'nothing is asked'),
        ('a16 a05 --port /nowhere', 'a16:1 and a05:1 have the same address'),
        ('a16@x a05:auto@y', 'in mode auto nothing is asked'),
        ('a16@x hps167s', '--port is missing'),
    ]),
    ('wrong_words_are_usage_errors', 'get', [
        ('a17', "no sensor 'a17'"),
        ('a16 address', '--port is missing'),
        ('a16 --port /nowhere colour', "unknown setting 'colour'. It is one of address, "),
        ('a16 --port /nowhere switch-treshold', 'Did you mean switch-threshold?'),
        ('a16 --port /nowhere operating-mode', 'write-only'),
    ]),
    ('wrong_words_are_usage_errors', 'set', [
        ('a16 --port /nowhere', 'the setting is missing'),
        ('a16 --port /nowhere address', 'the value is missing'),
        *((f'a16 --port /nowhere address {value}', '1 to 254') for value in ('255', '5x')),
        ('a16 --port /nowhere address 0', 'may not be found again'),
        ('a16 --port /nowhere address 5 --may-not-be-found-again', 'is for address 0 of an a16 or a05'),
        ('hps167s --port /nowhere address 0 --may-not-be-found-again', 'is for address 0 of an a16 or a05'),
        ('a16:0 --port /nowhere switch-threshold 500', 'goes to all units, so nothing can be set there'),
        ('a16 --port /nowhere distance 5', 'cannot be set'),
        ('hps167s --port /nowhere address 33', '1 to 32'),
        ('hps167s --port /nowhere reconnect-time 19', 'a multiple of 18'),
        ('hps167s --port /nowhere baud 9600', '57600'),
        ('a05 --mode modbus --port /nowhere every-address 5', '--mode dyp'),
    ]),
    *(('options_that_one_request_has_no_use_for_are_no_options', command, [
        (f'{words} --port /nowhere {option}', f'there is no option {option.split()[0]}')
        for option in ('--reconnect', '--interval 5', '--duration 5')])
      for command, words in (('info', 'a16'), ('get', 'a16 address'), ('set', 'a16 address 5'),
                             ('commission', 'a16 --addresses 2-3 --record /nowhere/record'),
                             ('calibrate', 'hps167s --known 2000'), ('save', 'a16'), ('restore', 'a16 --file /nowhere/file'),
                             ('reset', 'hps167s --yes-restore-factory-settings'))),
    ('wrong_words_are_usage_errors', 'reset', [
        ('a16 --port /nowhere --yes-restore-factory-settings', 'only an hps167s'),
        ('hps167s --port /nowhere', '--yes-restore-factory-settings'),
    ]),
]


class Wrong(e2e.Case):
    @e2e.each(**{f'{name}_{begin}_{number:02}': (f'{begin} {rest}', words) for name, begin, rows in WRONG
                 for number, (rest, words) in enumerate(rows)})
    def wrong(self, line, words):
        done = self.ends(line, 2, words, out='')
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        command = '' if 'there is no command' in words or not line.strip() else line.split()[0] + ' '
        self.assertTrue(done.err.endswith(f'; try: fathom {command}--help\n'), done.err)


class Help(e2e.Case):
    def told(self, line):
        done = self.run_fathom(line)
        self.assertEqual((done.code, done.err), (0, ''))
        self.assertTrue(all(len(line) < 125 for line in done.out.splitlines()))
        return done.out

    def test_the_version_is_that_of_the_library(self):
        with open(f'{e2e.ROOT}/include/fathom/version.h', encoding='ascii') as file:
            version = re.search('VERSION_STRING "(.*)"', file.read())[1]
        self.assertEqual(self.told('--version'), f'fathom {version}\n')

    def test_help_names_every_command(self):
        for word in ('--help', '-h'):
            self.assertRegex(self.told(word), r'(?s)\n  scan .*\n  read .*\n  watch .*\n  sim .*Exit status')

    @e2e.each(
        help_of_read_names_sensors_options_and_examples=(
            'read', '[NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,KEY=VALUE...]]... a16 a05 hps167s --port --rs485 --mode --address --baud --parity --stop-bits --count --interval --timeout '
                    '--retries '
            '--value --window --means --probes --first-register --temperature[=S] --median --gate --level --alarm --until-alarm --format --reconnect --echo --stats[=SECONDS] examples:', '19200 8E1'),
        help_names_what_is_to_be_seen=(
            'watch', '[NAME=]SENSOR[:ADDRESS][:MODE][@PORT[,KEY=VALUE...]]... --port --rs485 --interval --duration --reconnect --value --window NO_COLOR examples:', 'x no response'),
        the_help_names_every_option_and_its_examples_are_right_usage=(
            'scan', '--port --address --baud --parity --stop-bits --timeout --retries --listen --wake --estimate '
                    '--format '
            'examples:'))
    def names(self, command, words, *more):
        text = self.told(f'{command} --help')
        for word in (*words.split(), *more, 'Exit status'):
            self.assertIn(word, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 120, line)

    def test_help_wins_over_what_is_missing(self):
        self.assertEqual(self.told('read a17 --help'), self.told('read --help'))

    @e2e.each(each_example_of_the_help_is_right_usage=('read', 13, 'sim'),
              each_example_of_the_help_of_scan_is_right_usage=('scan', 3),
              each_example_of_the_help_of_watch_is_right_usage=('watch', 3))
    def examples(self, command, count, *more_pages):
        """Each is run with the port replaced by one that is not there: then 1, not 2, is the exit status."""
        pages = [self.told(f'{page} --help').split('examples')[1] for page in (command, *more_pages)]
        examples = re.findall(rf'fathom ({command} (?:(?! {{2}}|[|>\n]).)*)', ''.join(pages))
        self.assertEqual(len(examples), count)
        for example in examples:
            self.ends(re.sub('@/?', '@/nowhere/', re.sub(r'--port \S+', '--port /nowhere', example)), 1)

    def test_options_may_stand_before_and_after_the_sensor_and_the_last_one_counts(self):
        self.ends('read --interval 1s a16 --port /nowhere --interval 1', 1, '/nowhere: no such device')

    def test_what_has_no_effect_is_said(self):
        for option in ('--address 7', '--retries 7', '--echo on'):
            self.ends(f'read a16 --port /nowhere {option}', 1,
                      f'in mode auto nothing is asked, so {option.split()[0]} has no effect\n')
        self.ends('read a16@/nowhere,echo=on', 1, 'in mode auto nothing is asked, so echo= has no effect\n')
        told = self.run_fathom('read one=a16@/nowhere hps167s@/elsewhere --retries 7').err
        self.assertEqual(told.count('no effect'), 1)
        self.assertIn('fathom: one: in mode auto nothing is asked, so --retries has no effect\n', told)
        self.assertNotIn('no effect',
                         self.run_fathom('read a16 --port /nowhere --mode modbus --retries 7').err)


if __name__ == '__main__':
    e2e.main()
