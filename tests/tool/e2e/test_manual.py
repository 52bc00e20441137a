#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pages of man, which are made from the help: no word of it is lost on the way. That each command has a page, and
which sections it has, is looked at in tests/tool/package."""
import collections
import re
import subprocess

import e2e
import shells

WORD = re.compile(r"[^\s;`:,.()]+")
HEADS = ('usage:', 'Exit status:', 'examples:', 'examples, each with what reads it:')  # sections in the pages


def words(text):
    return collections.Counter(WORD.findall(text))


class Manual(e2e.Case):
    def page(self, name):
        """As mandoc shows it, in lines without end."""
        with open(self.path('page'), 'wb') as file:
            file.write(subprocess.run(['gzip', '-dc', f'{shells.PAGES}/man1/{name}.1.gz'], stdout=subprocess.PIPE,
                                      check=True).stdout)
        done = subprocess.run(['mandoc', '-T', 'ascii', '-O', 'width=999', self.path('page')], stdout=subprocess.PIPE,
                              check=True, text=True)
        text = re.sub('.\b', '', done.stdout)  # bold and underlined
        return re.sub(r'fathom-(\w+)\(1\)', r'\1', text) if name == 'fathom' else text

    def lost(self, name, told):
        for head in HEADS:
            told = re.sub(rf'^{re.escape(head)}', '', told, flags=re.M)
        return words(told) - words(self.page(name))

    def test_no_word_of_a_help_is_lost(self):
        overview = self.run_fathom('--help').out
        self.assertEqual(self.lost('fathom', overview), {})
        for command in re.findall(r'^  (\w+) +\S', overview.split('\n\n')[2], re.M):
            self.assertEqual(self.lost(f'fathom-{command}', self.run_fathom(command, '--help').out), {}, command)


if __name__ == '__main__':
    e2e.main()
