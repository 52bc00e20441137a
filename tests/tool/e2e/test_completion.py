#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The completions of bash, zsh and fish: each shell offers what the tool takes, no more and no less, in every
command."""
import glob
import os
import re

import e2e
import shells

OPTION_ROW = re.compile(r'\{"([\w-]+)", (?:no|required|optional)_argument')
# Options that are taken and then refused, by a message that says why: not offered.
ASKS_ONCE = {'info', 'get', 'set', 'commission', 'calibrate', 'save', 'restore', 'reset'}
REFUSED = {'save': {'--format'}, 'restore': {'--format'}}

# A line up to where the key is pressed, and all the words that are offered then.
OFFERED = {
    'fathom re': 'read restore reset request',
    'fathom --ver': '--version',
    'fathom read hps': 'hps167s hps167s:modbus hps167s:auto',
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
    'fathom read --first-register ': '0x0106 0x0010',
    'fathom request 1 3 0 --sensor ': 'a16 a05 hps167s',
    'fathom decode --protocol ': 'auto modbus dyp stream',
    'fathom sim hps167s --baud ': '19200 57600 115200 230400',
    'fathom sim a16 --fault fl': 'flip-bit flip-byte',
    'fathom sim hps167s --with wa': 'warm-up= warm-up-04 warm-up-ff',
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


def names_of_options():
    """Every option that any command has in its table, also one that no help names."""
    found = set()
    for path in glob.glob(os.path.join(e2e.ROOT, 'examples/fathom/**/*.[ch]'), recursive=True):
        with open(path, encoding='utf-8') as file:
            found.update('--' + name for name in OPTION_ROW.findall(file.read()))
    return found


class Completion(e2e.Case):
    def setUp(self):
        super().setUp()
        with open(self.path('log.txt'), 'w', encoding='ascii'):
            pass

    def commands(self):
        return re.findall(r'^  (\w+) +\S', self.run_fathom('--help').out.split('\n\n')[2], re.M)

    def taken(self, command):
        """The options that the tool does not call unknown, but for those that are the begin of another one."""
        def takes(*words):
            return 'there is no option' not in self.run_fathom(command, *words).err

        told = self.run_fathom(command, '--help').out
        # What one request has no use for is refused behind the sensor only.
        behind = ['a16'] if command in ASKS_ONCE else []
        taken = {name for name in names_of_options() if takes(*behind, name, *(['1'] if behind else []))}
        begins = {name for name in taken if not re.search(rf'{name}(?![\w-])', told) and
                  any(other.startswith(name) and other != name for other in taken)}
        return taken - begins - REFUSED.get(command, set())

    def complete(self, shell, lines):
        return zip(lines, shells.SHELLS[shell](lines, self.folder))

    @e2e.each(**{shell: (shell,) for shell in shells.SHELLS})
    def words(self, shell):
        for line, words in self.complete(shell, list(OFFERED)):
            self.assertEqual(words, set(OFFERED[line].split()), (shell, line))

    def test_every_option_of_every_command_and_no_other(self):
        commands = self.commands()
        wanted = {'fathom ': {'--help', '--version', *commands},
                  **{f'fathom {command} --': self.taken(command) for command in commands}}
        for shell in shells.SHELLS:
            for line, words in self.complete(shell, list(wanted)):
                self.assertEqual(words | ({'--help', '--version'} if line == 'fathom ' else set()), wanted[line],
                                 (shell, line))


if __name__ == '__main__':
    e2e.main()
