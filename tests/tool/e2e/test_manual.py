#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The man pages, which the tool prints: each has every word of the help or of the topic that it is made of. Which sections
a page has is looked at in tests/tool/package."""
import collections
import re
import subprocess

import e2e
import shells

WORD = re.compile(r"[^\s;`:,.()]+")
HEADS = ('Usage:', 'Exit status:', 'Examples:', 'More: fathom help .*')  # sections in the pages


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
        return re.sub('.\b', '', done.stdout)  # bold and underlined

    def lost(self, name, told):
        for head in HEADS:
            told = re.sub(rf'^{head}', '', told, flags=re.M)
        return words(told) - words(self.page(name))

    def test_no_word_of_a_help_is_lost(self):
        commands = re.findall(r'^  (\w+) {2,}\S', self.run_fathom('--help').out.split('First steps')[0], re.M)
        self.assertGreater(len(commands), 14)
        for command in commands:
            self.assertEqual(self.lost(f'fathom-{command}', self.run_fathom(command, '--help').out), {}, command)

    def test_no_word_of_a_topic_is_lost(self):
        topics = re.findall(r'^    (\w+) +\S', self.run_fathom('--help').out.split('TOPIC is one of')[1], re.M)
        self.assertGreater(len(topics), 10)
        for topic in topics:
            self.assertEqual(self.lost('fathom', self.run_fathom('help', topic).out), {}, topic)


if __name__ == '__main__':
    e2e.main()
