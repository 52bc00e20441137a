#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/site.c, a user's program of two lines and a pin by fathom_loop.h: how long it is, that it is built as it says,
what it reads, and what it does when a port is lost. Each port is a link, behind which simulated sensors come and go; the
pin is a stand-in. It needs real time: CTest runs one such file at a time."""
import os
import re
import shlex
import signal
import struct
import subprocess
import time

import e2e

PROGRAM = os.path.join(os.environ.get('FATHOM_BUILD', ''), 'examples', 'example_site')
SOURCE = os.path.join(e2e.ROOT, 'examples', 'site.c')
RISING, FALLING = 1, 2  # linux/gpio.h, enum gpio_v2_line_event_id
LOST = 'the device was unplugged or its far end closed'


def text():
    with open(SOURCE, encoding='utf-8') as file:
        return file.read()


class Site(e2e.Case):
    def setUp(self):
        super().setUp()
        os.mkfifo(self.path('events'))
        self.events = os.open(self.path('events'), os.O_RDWR | os.O_NONBLOCK)
        self.addCleanup(os.close, self.events)
        self.edges = 0
        self.level(True)

    def level(self, is_high):
        with open(self.path('new'), 'w', encoding='ascii') as file:
            file.write('1' if is_high else '0')
        os.replace(self.path('new'), self.path('level'))

    def edge(self, is_high):
        """Of the pin: the level, and the event that wakes the program."""
        self.edges += 1
        self.level(is_high)
        os.write(self.events, struct.pack('=QIIII24x', time.monotonic_ns(), RISING if is_high else FALLING, 17,
                                          self.edges, self.edges))

    def plug(self, name, sensor):
        """A simulated sensor behind the link of this name."""
        return self.sim(sensor, ['--link', self.path(name)])

    def gate(self, mm):
        return self.plug('gate', f'hps167s --distance {mm}')

    def tank(self, mm):
        return self.plug('tank', f'a16:1:modbus --distance {mm}')

    def site(self, program=PROGRAM, **options):
        environment = self.preload('gpio_shim.c', GPIO_LEVEL=self.path('level'), GPIO_EVENTS=self.path('events'))
        return self.start([program, self.path('gate'), self.path('tank'), 'gpiochip0'], env=environment, **options)

    def cpu(self, program):
        """Seconds of a processor that it has used."""
        with open(f'/proc/{program.process.pid}/schedstat', encoding='ascii') as file:
            return int(file.read().split()[0]) / 1e9

    def test_it_is_of_forty_lines_at_most(self):
        lines = re.sub(r'(?s)/\*.*?\*/', '', text()).splitlines()
        self.assertLessEqual(len([line for line in lines if line.strip()]), 40)
        self.assertLessEqual(max(map(len, lines)), 120)
        self.assertLessEqual(text().count(';') + text().count('{'), 2 * 40)  # nor are they crammed

    def test_the_line_that_compiles_it_does(self):
        """As it is printed, with this build's compiler and folder."""
        line = re.search(r'(?s)\* +cc (.*?) -o site$', re.sub(r'\\\n \* +', '', text()), re.M)[1]
        site, build = self.path('site'), os.environ['FATHOM_BUILD'] + '/'
        subprocess.run([os.environ['CC'], *shlex.split(os.environ['CFLAGS']),
                        *(re.sub('^build/', build, word) for word in line.split()), '-o', site], cwd=e2e.ROOT, check=True)
        self.gate(2083)
        self.tank(1953)
        self.site(site).expect('^gate: 2083 mm$')

    def test_it_reads_all_three(self):
        self.gate(2083)
        self.tank(1953)
        site = self.site()
        for words in ('gate: 2083 mm', 'tank: 1953 mm', 'door: far'):
            site.searched['out'] = 0
            site.expect(f'^{words}$')
        self.edge(False)  # the relay closes to ground
        site.expect('^door: near$')
        self.edge(True)
        site.expect('^door: far$')

    def test_a_port_that_is_not_there_yet_is_opened_when_it_comes(self):
        self.tank(1953)
        site = self.site()
        site.expect('gate: no such device', 'err')
        site.expect('^tank: 1953 mm$')
        self.gate(2084)
        site.expect('^gate: 2084 mm$')

    def test_a_lost_port_takes_less_than_a_hundredth_of_a_processor_and_is_opened_again(self):
        gate = self.gate(2083)
        self.tank(1953)
        site = self.site()
        site.expect('^gate: 2083 mm$')
        gate.end(signal.SIGKILL)
        site.expect('^gate: PORT$')
        site.expect(LOST, 'err')
        used, rows, began = self.cpu(site), len(site.lines()), time.monotonic()
        site.has_ended(5.5)
        passed = time.monotonic() - began
        share = (self.cpu(site) - used) / passed
        away = site.lines()[rows:]
        print(f'one of its ports lost: {100 * share:.2f} % of a processor over {passed:.1f} s')
        self.assertLess(share, 0.01)  # 0.04 % on an idle machine
        self.assertGreaterEqual(passed, 5)
        self.assertGreaterEqual(away.count('tank: 1953 mm'), 5)  # the others go on; 10 on an idle machine
        self.assertFalse([line for line in away if line.startswith('gate')])
        # at most one error a pause: after 0.5, 1, 2 and 4 s
        self.assertLessEqual(site.said['err'].decode().count('gate: '), 1 + 4)
        self.gate(2084)
        site.expect('^gate: 2084 mm$')

    def test_it_stops_where_its_output_is_broken(self):
        self.gate(2083)
        self.tank(1953)
        with open('/dev/full', 'w', encoding='utf-8') as full:
            self.ends(self.site(stdout=full), 1)

    def test_a_chip_that_is_not_there_is_said(self):
        self.ends(self.start([PROGRAM, 'x', 'y', '/nowhere']), 1, '/nowhere', out='')

    def test_without_its_arguments_it_is_wrong_usage(self):
        self.ends(self.start([PROGRAM]), 2, out='')


if __name__ == '__main__':
    e2e.main()
