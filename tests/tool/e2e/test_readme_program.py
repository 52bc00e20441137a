#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The lines of the README that compile its two programs. The programs themselves are examples/linux/first.c and
examples/avr/first.c, which have their own tests."""
import os
import re
import shlex
import subprocess

import e2e


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
