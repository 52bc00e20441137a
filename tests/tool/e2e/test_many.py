#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read with sensors on several ports: one of them is killed and started again, or is a connection to nothing,
and the others do not pause. It needs real time: CTest runs one such file at a time."""
import re
import signal

import e2e
import tcp_server

INTERVAL = 0.1
PAUSE = 4  # seconds; a connection that is waited for would make it 5 s


class Case(tcp_server.Case):
    def setUp(self):
        super().setUp()
        self.sims = {}

    def sensor(self, name, sensor='hps167s', more=''):
        """A simulated one behind a link of this name."""
        link = self.path(name)
        self.sims[name] = self.sim(f'{sensor} --link {link} {more}')
        return f'{name}={sensor}@{link}'

    def begin(self, *words, options=''):
        return self.fathom('read', list(words), f'--interval {int(INTERVAL * 1000)} --timeout 2000 {options}')

    def times(self, program, name):
        """When there were readings of this sensor, in seconds; of what has come so far."""
        lines = program.said['out'].decode().splitlines()
        return [float(line.split()[0]) for line in lines if line.split()[2] == name]

    def longest(self, program, name):
        times = self.times(program, name)
        return max(later - before for before, later in zip(times, times[1:]))

    def has(self, program, name, count):
        """So many more readings of it come."""
        goal = len(self.times(program, name)) + count
        if not program.hear(lambda: len(self.times(program, name)) >= goal):
            program.fail(f'{count} more readings of {name} did not come')


class Lost(Case):
    def test_one_of_three_is_killed_and_started_again_and_the_others_do_not_pause(self):
        one, two, three = (self.sensor(name) for name in ('one', 'two', 'three'))
        reader = self.begin(one, two, three, options='--reconnect --stats')
        self.has(reader, 'two', 5)
        self.sims['two'].end(signal.SIGKILL)
        reader.expect(f'{self.path("two")}: .*. Waiting until it is back$', 'err')
        before = len(self.times(reader, 'two'))
        self.has(reader, 'one', 20)
        self.assertEqual(len(self.times(reader, 'two')), before)
        self.sensor('two')
        reader.expect(f'{self.path("two")}: it is back; reading goes on$', 'err')
        self.has(reader, 'two', 5)
        done = self.ends(reader.end(signal.SIGINT), 1, re.compile(r'two: attempts \d+, failed 1, '))
        for name in ('one', 'three'):
            self.assertLess(self.longest(reader, name), PAUSE, name)
            self.assertRegex(done.err, rf'{name}: attempts \d+, failed 0, ')
        # The pauses of a port that is waited for are 0.5, 1, 2, 4, 8, ... s: one reading in each would take too long above.
        times = self.times(reader, 'two')
        between = [one for one in self.times(reader, 'one') if times[before - 1] < one < times[before]]
        self.assertGreaterEqual(len(between), 20)
        self.assertEqual(done.err.count('Waiting until'), 1)


class Paths(Case):
    """One serial port by two names, such as /dev/ttyUSB0 and what stands for it in /dev/serial/by-id."""

    def test_two_sensors_share_it(self):
        link = self.path('bus')
        sim = self.sim(f'hps167s:1 hps167s:7 --link {link}')
        for other in (sim, f'{self.folder}/./bus'):
            self.ends(['read', f'one=hps167s:1@{link}', f'seven=hps167s:7@{other}', '--count', '2', '--stats'], 0,
                      'one: attempts 2, failed 0', 'seven: attempts 2, failed 0')


class Connections(Case):
    def test_a_connection_that_does_not_come_to_stand_does_not_keep_the_others_waiting(self):
        reader = self.begin(self.sensor('one'), f'far=hps167s@{self.full()}', options='--reconnect --stats')
        reader.expect('Connection timed out: nothing answers at this address', 'err')  # after 5 s
        self.assertGreater(len(self.times(reader, 'one')), 5)  # some 50 on an idle machine
        self.has(reader, 'one', 5)
        self.ends(reader.end(signal.SIGINT), 0, 'one: attempts ')
        self.assertLess(self.longest(reader, 'one'), PAUSE)


class Cost(Case):
    def test_no_read_of_a_port_brings_nothing(self):
        """Eight ports: a read for each response, but for those at the start, and one more where a busy machine woke the
        program late. Polling all of them whenever one has something would make it eight."""
        words = [self.sensor(f's{n}') for n in range(8)]
        reader = self.begin(*words)

        def reads():
            with open(f'/proc/{reader.process.pid}/io', encoding='ascii') as file:
                return int(re.search(r'syscr: (\d+)', file.read())[1])
        self.has(reader, 's7', 3)
        before, lines = reads(), len(reader.lines())
        self.has(reader, 's7', 20)
        count, read = len(reader.lines()) - lines, reads() - before
        self.assertGreater(count, 120)
        self.assertLess(read, 2.2 * count)
        reader.end()


if __name__ == '__main__':
    e2e.main()
