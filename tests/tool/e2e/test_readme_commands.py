#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The commands that the pages show: the tool understands each, and those that need no real sensor work. The tool's own page
names every command. The lines of README.md compile its two programs, which have their own tests."""
import concurrent.futures
import os
import re
import shlex
import signal
import subprocess

import e2e

BLOCK = r'^build/fathom ([^#&\n]*[^#&\s])'
CELL = r'^\|(?:[^|\n]*\|){3} `([^`\n]+)` \|[^|\n]*\|$'


def text_of(page):
    with open(os.path.join(e2e.ROOT, page), encoding='utf-8') as file:
        return file.read()


class Commands(e2e.Case):
    def check(self, words):
        """Wrong usage is 2, and a port that is not there is 1."""
        if words[0] == 'sim':
            words = [self.path('link') if before == '--link' else word for before,
                     word in zip(['', *words], words)]
            sim = self.fathom(words)
            sim.expect(r'^\S*(/dev/pts/\d+)$')
            self.assertEqual(sim.end(signal.SIGINT).code, 0)
        elif words[0] == 'publish':
            self.check_publish(words)
        elif words[0] == 'decode':
            done = self.run_fathom(words)
            self.assertNotEqual(done.code, 2, done.err)
            self.assertEqual(done.code == 0, 'C8' not in words, done.out)  # C5 C8 is the datasheet's misprint
        else:
            waits = '--reconnect' in words  # for the port
            self.ends([*self.at_no_port(words), *(['--duration', '1'] if waits else [])], 0 if waits else 1,
                      self.path('none'))

    def check_publish(self, words):
        """With the page's file, of which the paths are the test's."""
        text = re.search(r'(?s)^```yaml\n(.*?)^```', text_of('examples/fathom/README.md'), re.M)[1]
        text = re.sub('/etc/.*/|/dev/', f'{self.folder}/', text).replace('broker.lan', '127.0.0.1')
        for name, content in (('site.yaml', text), ('password', 'secret'), ('ca-certificates.crt', '')):
            with open(self.path(name), 'w', encoding='ascii') as file:
                file.write(content)
        program = self.fathom([self.path(word) if word == 'site.yaml' else word for word in words])
        if 'not in this build' in self.run_fathom('--help').out:
            self.ends(program, 2, 'this fathom was built without ')
        elif '--check' in words:
            self.ends(program, 0, out=None)
        else:
            program.expect('waiting until it is there', 'err')
            self.ends(program.end(signal.SIGINT), 0)

    def at_no_port(self, words):
        """Each port, behind --port and behind @, is one that is not there."""
        none = self.path('none')
        there = [none if before == '--port' else
                 re.sub('@[^,]+', f'@{none}/gpiochip0' if '@gpiochip' in word else f'@{none}{number}', word)
                 for number, (before, word) in enumerate(zip(['', *words], words))]
        self.assertNotEqual(there, words)
        return there

    @e2e.each(those_of_the_first_page=('README.md', BLOCK, 1, 1),
              those_of_the_manual=('examples/fathom/README.md', BLOCK, 14, 26),
              those_of_the_table_of_the_datasheets=('include/README.md', CELL, 51, 500))
    def shown(self, page, pattern, at_least, at_most):
        shown = re.findall(pattern, text_of(page), re.M)
        self.assertTrue(at_least <= len(shown) <= at_most, shown)
        for line in shown:
            with self.subTest(line):
                self.check(shlex.split(line))

    def test_the_page_names_every_command(self):
        page = text_of('examples/fathom/README.md')
        commands = re.findall(r'^  (\w+) +\S', self.run_fathom('--help').out.split('Help:')[0].split('First steps:')[0], re.M)
        self.assertEqual(len(commands), 16, commands)
        for command in commands:
            self.assertIn(f'`fathom {command}`', page)


class Symptoms(e2e.Case):
    """The page of symptoms: the commands below a symptom print it."""

    def test_each_symptom_is_reproduced_by_its_commands(self):
        page = self.run_fathom('help symptoms').out
        rows = re.findall(r'^  (\S.*)\n((?: {6}.*\n)+)', page, re.M)
        self.assertGreaterEqual(len(rows), 12, page)
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            for symptom, shown in pool.map(self.reproduce, range(len(rows)), rows):
                self.assertIn(symptom, shown)

    def reproduce(self, number, row):
        """The last command ends; those before it go on meanwhile."""
        symptom, text = row
        commands = re.findall(r'^ {8}((?:fathom|cat) .*)$', text, re.M)
        self.assertTrue(commands, symptom)
        programs = []
        for command in commands:
            words = re.sub(r'\./(line|other)', lambda name: self.path(f'{name[1]}{number}'), command)
            if words.startswith('fathom sim'):
                programs.append(self.sim(words.split(' ', 2)[2]))
            elif words.startswith('cat '):
                programs.append(self.start(['sh', '-c', 'echo started; exec ' + words]))
                programs[-1].expect('started')
            else:
                programs.append(self.fathom(words.split(' ', 1)[1]))
                programs[-1].until_asleep() if command != commands[-1] else programs[-1].finish(60)
        done = programs[-1].done
        for program in programs[:-1]:
            program.end()
        return symptom, done.out + done.err


class Lines(e2e.Case):
    def save(self, number, name):
        """Of the page's programs the one with this number, from 0. Returns the page, and where it is."""
        with open(os.path.join(e2e.ROOT, 'README.md'), encoding='utf-8') as file:
            text = file.read()
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(re.findall(r'(?sm)^```c\n(.*?)^```$', text)[number])
        return text, self.path(name)

    def test_the_line_that_compiles_it_does(self):
        """As it is printed, with this build's compiler and folder."""
        text, source = self.save(0, 'gate.c')
        gate = self.path('gate')
        line = re.search(r'(?m)^cc (.*) gate\.c (.*) -o gate$', text)
        build = os.environ['FATHOM_BUILD'] + '/'
        subprocess.run([os.environ['CC'], *shlex.split(os.environ['CFLAGS']), *line[1].split(), source,
                        *(word.replace('build/', build) for word in line[2].split()), '-o', gate], cwd=e2e.ROOT,
                       check=True)
        self.start([gate, str(self.sim('hps167s --distance 2083'))]).expect('^2083 mm$')

    def test_the_line_that_compiles_the_one_for_a_microcontroller_does(self):
        text, source = self.save(1, 'tank.c')
        image = self.path('tank.elf')
        line = re.search(r'(?ms)^avr-gcc .*? -o tank\.elf$', text)[0]
        line = line.replace('tank.c', shlex.quote(source)).replace('-o tank.elf', '-o ' + shlex.quote(image))
        subprocess.run(line, cwd=e2e.ROOT, shell=True, check=True)
        with open(image, 'rb') as file:
            self.assertEqual(file.read(20)[18:], b'\x53\0')  # e_machine 83: AVR


if __name__ == '__main__':
    e2e.main()
