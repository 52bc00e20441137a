#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The completions of bash, zsh and fish: each shell offers what the tool takes, no more and no less, in every
command."""
import re
import subprocess

import e2e
import shells

OPTION = re.compile(r'^ +(?:-\w, )?(--[\w-]+)', re.M)

# A line up to where the key is pressed, and all the words that are offered then.
OFFERED = {
    'fathom re': 'read restore reset request',
    'fathom --ver': '--version',
    'fathom help al': 'alarm',
    'fathom read hps': 'hps167s hps167s:modbus hps167s:auto hps-167 hps-167u hps-166',
    'fathom read sen031': 'sen0313 sen0311 sen0312',
    'fathom read aj-sr04m:': 'aj-sr04m:auto aj-sr04m:controlled aj-sr04m:pwm',
    'fathom models jsn-sr20': 'jsn-sr20-y1 jsn-sr20',
    'fathom read a16:1:modbus a05:re': 'a05:relay',  # several
    'fathom info a05:': 'a05:modbus a05:dyp',  # those in which it is asked
    'fathom calibrate ': 'hps167s',
    'fathom read --format ': 'text json csv',
    'fathom scan --format ': 'text json',
    'fathom read --format=': '--format=text --format=json --format=csv',
    'fathom read a16 --format j': 'json',
    'fathom read a16 --parity ': 'none even odd',
    'fathom read a16 --baud 1': '19200 115200',
    'fathom read a16 --echo ': 'auto on off',
    'fathom read --value ': 'processed real-time',
    'fathom read --rotate ': 'day',
    'fathom read a16 --level h': 'height=',
    'fathom read a16 --alarm un': 'unknown= unknown-after=',
    'fathom request 1 3 0 --sensor ': 'a16 a05 hps167s',
    'fathom decode --protocol ': 'auto modbus dyp stream',
    'fathom sim hps167s --baud ': '19200 57600 115200 230400',
    'fathom sim a16 --fault fl': 'flip-bit flip-byte',
    'fathom sim hps167s --with wa': 'warm-up warm-up-04 warm-up-ff',
    'fathom get a16:3 sw': 'switch-polarity switch-threshold',
    'fathom set --port ./x a16 switch-polarity ': 'negative positive',
    'fathom set hps167s:7 --retries 2 termination ': 'off on',
    'fathom decode log': 'log.txt',
    'fathom read a16 --output log': 'log.txt',
    'fathom read a16 --port lo': 'log.txt',
    'fathom read a16 -p lo': 'log.txt',
    'fathom save a16 --file=lo': '--file=log.txt',
    'fathom read --count ': '',
}


class Completion(e2e.Case):
    def setUp(self):
        super().setUp()
        with open(self.path('log.txt'), 'w', encoding='ascii'):
            pass

    def commands(self):
        text = subprocess.run([e2e.FATHOM, 'complete', ''], stdout=subprocess.PIPE, text=True, check=True).stdout
        return [line.split('\t')[0] for line in text.splitlines()]

    def complete(self, shell, lines):
        return zip(lines, shells.SHELLS[shell](lines, self.folder))

    @e2e.each(**{shell: (shell,) for shell in shells.SHELLS})
    def words(self, shell):
        for line, words in self.complete(shell, list(OFFERED)):
            self.assertEqual(words, set(OFFERED[line].split()), (shell, line))

    def test_every_option_that_a_help_names_and_no_other(self):
        commands = [command for command in self.commands() if command != 'help']
        self.assertGreater(len(commands), 14)
        wanted = {f'fathom {command} --': {'--help', *OPTION.findall(self.run_fathom(command, '--help').out)}
                  for command in commands}
        for shell in shells.SHELLS:
            for line, words in self.complete(shell, list(wanted)):
                self.assertEqual(words, wanted[line], (shell, line))


if __name__ == '__main__':
    e2e.main()
