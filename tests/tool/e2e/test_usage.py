#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Help, man pages and version, and that the examples of the help are right. test_tool_usage.c has wrong usage, and the
width of each page; which sections a man page has is looked at in tests/tool/package."""
import collections
import re
import subprocess

import e2e

WORD = re.compile(r"[^\s;`:,.()]+")
HEADS = ('Usage:', 'Exit status:', 'Examples:', 'More: fathom help .*')  # sections in the pages


class Help(e2e.Case):
    def told(self, line):
        done = self.run_fathom(line)
        self.assertEqual((done.code, done.err), (0, ''))
        return done.out

    def test_the_version_is_that_of_the_library(self):
        with open(f'{e2e.ROOT}/include/fathom/version.h', encoding='ascii') as file:
            version = re.search('VERSION_STRING "(.*)"', file.read())[1]
        for word in ('--version', '-v'):
            self.assertEqual(self.told(word), f'fathom {version}\n')

    def test_help_names_every_command(self):
        for word in ('--help', '-h', 'help'):
            self.assertRegex(self.told(word), r'(?s)\n  scan .*\n  read .*\n  watch .*\n  sim .*Exit status')

    def test_the_configuration_in_the_help_can_be_copied(self):
        sample = self.told('help config').split('YAML file:\n\n')[1].split('\n\nIts keys')[0]
        for name, text in (('password', 'secret\n'),
                           ('site.yaml', sample.replace('/etc/fathom/password', self.path('password')) + '\n')):
            with open(self.path(name), 'w', encoding='ascii') as file:
                file.write(text)
        checked = self.told(f'publish --check {self.path("site.yaml")}')
        self.assertRegex(checked, r'(?s)fathom/mill/tank/level.*fathom/mill/gate/state')

    def test_a_command_in_the_help_stands_on_its_own_line(self):
        self.assertIn('\n  --level mounting=2300,height=2000,capacity=5000\n', self.told('help level'))
        trouble = self.told('help trouble')
        self.assertIn('\n       fathom scan --port PORT\n', trouble)
        self.assertIn('\n       fathom scan --port PORT --address 1-254 --baud all --parity all\n', trouble)

    @e2e.each(**{command: (command, topic) for command, topic in (
        ('commission', 'commissioning'), ('save', 'backup'), ('restore', 'backup'), ('read', 'log'),
        ('calibrate', 'calibration'), ('request', 'requests'), ('publish', 'publishing'))})
    def topic(self, command, topic):
        """The help of a command names the topic that explains its task."""
        self.assertRegex(self.told(f'{command} --help'), rf'\nMore: fathom help (?:\w+, )*{topic}[,.]')

    def test_help_wins_over_what_is_missing(self):
        self.assertEqual(self.told('read a17 --help'), self.told('read --help'))

    @e2e.each(each_example_of_the_help_is_right_usage=('read', 3),
              each_example_of_the_help_of_scan_is_right_usage=('scan', 4),
              each_example_of_the_help_of_watch_is_right_usage=('watch', 3))
    def examples(self, command, count, *more_pages):
        """Each is run with the port replaced by one that is not there: then 1, not 2, is the exit status."""
        pages = [self.told(f'{page} --help').split('Examples:')[1] for page in (command, *more_pages)]
        examples = re.findall(rf'fathom ({command} (?:(?! {{2}}|[|>\n]).)*)', ''.join(pages))
        self.assertEqual(len(examples), count)
        for example in examples:
            self.ends(re.sub('@/?', '@/nowhere/', re.sub(r'(--port|-p) \S+', '--port /nowhere', example)), 1)

    def test_options_may_stand_before_and_after_the_sensor_and_the_last_one_counts(self):
        self.ends('read --interval 5 a16 --port /nowhere --interval 1', 1, '/nowhere: no such device')

    def test_the_name_of_a_port_in_windows(self):
        self.ends('read a16 --port COM3', 1, 'COM3: no such device', 'a path begins with /dev/')

    def lost(self, told, *page):
        """The words of a help or of a topic that its man page, as mandoc shows it in lines without end, does not have."""
        done = subprocess.run(['mandoc', '-T', 'ascii', '-O', 'width=999'], input=self.told(f'help --man {" ".join(page)}'),
                              stdout=subprocess.PIPE, check=True, text=True)
        for head in HEADS:
            told = re.sub(rf'^{head}', '', told, flags=re.M)
        words, kept = (collections.Counter(WORD.findall(text)) for text in (told, re.sub('.\b', '', done.stdout)))
        return words - kept

    def test_no_word_of_the_help_is_lost_in_a_man_page(self):
        commands, topics = self.told('--help').split('TOPIC is one of')
        commands = re.findall(r'^  (\w+) {2,}\S', commands.split('First steps')[0], re.M)
        topics = re.findall(r'^    (\w+) +\S', topics, re.M)
        self.assertEqual((len(commands), len(topics)), (16, 23))
        for command in commands:
            self.assertEqual(self.lost(self.told(f'{command} --help'), command), {}, command)
        for topic in topics:
            self.assertEqual(self.lost(self.told(f'help {topic}')), {}, topic)


if __name__ == '__main__':
    e2e.main()
