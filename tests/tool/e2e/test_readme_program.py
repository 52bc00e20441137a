#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The README's program for Linux, as it is printed there: what it says of a simulated HPS-167S, and how it ends."""
import os
import re
import shlex
import subprocess

import e2e

PROGRAM = os.path.join(os.environ.get('FATHOM_BUILD', ''), 'tests', 'tool', 'readme_linux')


class Gate(e2e.Case):
    def gate(self, *arguments, **options):
        return self.start([PROGRAM, *arguments], **options)

    @e2e.each(a_distance=('--distance 2083', '2083 mm'), nothing_in_range=('--distance no-target', 'nothing in range'),
              a_device_that_has_failed=('--distance fault', 'no distance'),
              a_damaged_response=('--fault flip-byte', 'no reading: CHECKSUM'))
    def reading(self, sensor, words):
        sim = self.sim('hps167s', sensor)
        gate = self.gate(sim)
        gate.expect(f'^{words}$')
        gate.expect(f'^{words}$')

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

    def test_after_a_silence_it_goes_on(self):
        gate = self.gate(self.sim('hps167s --distance 2083 --fault silence=1@2'))
        gate.expect('^2083 mm$')
        gate.expect('^no reading: NO_RESPONSE$')
        gate.expect('^2083 mm$')

    def test_it_ends_when_the_port_is_lost(self):
        sim = self.sim('hps167s --distance 2083')
        gate = self.gate(sim)
        gate.expect('^2083 mm$')
        sim.end()
        self.ends(gate, 1, sim.port)

    def test_a_port_that_is_not_there_is_said(self):
        self.ends(self.gate('/nowhere'), 1, '/nowhere', out='')

    def test_without_a_port_it_says_how_it_is_used(self):
        self.ends(self.gate(), 1, 'usage: gate PORT', out='')

    def test_it_ends_when_its_output_is_broken(self):
        with open('/dev/full', 'w', encoding='utf-8') as full:
            gate = self.gate(self.sim('hps167s'), stdout=full)
            self.ends(gate, 1, 'the output is broken')


if __name__ == '__main__':
    e2e.main()
