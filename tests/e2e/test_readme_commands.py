#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The commands that the README shows: the tool understands each, and those that need no real sensor work."""
import os
import re
import shlex
import signal

import e2e

BLOCK = r'^build/fathom ([^#&\n]*[^#&\s])'
CELL = r'^\|(?:[^|\n]*\|){3} `([^`\n]+)` \|[^|\n]*\|$'


class Commands(e2e.Case):
    def check(self, words):
        """Wrong usage is 2, and a port that is not there is 1."""
        if words[0] == 'sim':
            words = [self.path('link') if before == '--link' else word for before,
                     word in zip(['', *words], words)]
            sim = self.fathom(words)
            sim.expect(r'^\S*(/dev/pts/\d+)$')
            self.assertEqual(sim.end(signal.SIGINT).code, 0)
        elif words[0] == 'decode':
            done = self.run_fathom(words)
            self.assertNotEqual(done.code, 2, done.err)
            self.assertEqual(done.code == 0, 'C8' not in words, done.out)  # C5 C8 is the datasheet's misprint
        else:
            at = words.index('--port') + 1
            waits = '--reconnect' in words  # for the port
            words = [*words[:at], self.path('none'), *words[at + 1:], *(['--duration', '1'] if waits else [])]
            self.ends(words, 0 if waits else 1, self.path('none'))

    @e2e.each(those_of_the_introduction=(BLOCK, 8, 8), those_of_the_table_of_the_datasheets=(CELL, 51, 500))
    def shown(self, pattern, at_least, at_most):
        with open(os.path.join(e2e.ROOT, 'README.md'), encoding='utf-8') as file:
            shown = re.findall(pattern, file.read(), re.M)
        self.assertTrue(at_least <= len(shown) <= at_most, shown)
        for line in shown:
            with self.subTest(line):
                self.check(shlex.split(line))

    def test_a_command_that_is_wrong_would_be_seen(self):
        for line in ('set a16 --port P switch-treshold 2000', 'read a17 --port P',
                     'set hps167s --port P reconnect-time 361'):
            with self.assertRaises(AssertionError):
                self.check(line.split())


if __name__ == '__main__':
    e2e.main()
