# SPDX-License-Identifier: MIT
"""A round: simulated sensors behind links, one reader of all of them, and what happens to both for some seconds.

No two simulated sensors of a round, nor one before it was killed and after, measure the same distance; so each row
says by its distance who has answered, and until when that one lived."""
import collections
import os
import signal
import time

import e2e

HOLDS = 2.5  # seconds in which things happen
BACK = 80    # until each sensor is read again: ten times the longest pause between two tries to open a port
LATE = 0.4   # seconds: how long after the end of a simulated sensor a reading of it may bear its time
SENSORS = {  # words for the tool, and whether a damaged frame is always seen, by a CRC
    'gate': ('hps167s:7', True), 'tank': ('a16:1:modbus', True), 'hall': ('a05:2:modbus', True),
    'silo': ('a16::auto', False), 'pit': ('a05:3:dyp', False)}
DAMAGE = ('flip-byte', 'drop', 'truncate', 'noise', 'split', 'late', 'silence', 'unit')

Life = collections.namedtuple('Life', 'name killed')


class Wrong(AssertionError):
    """What must not happen."""


class Site:
    """The simulated sensors and whose distance is whose."""

    def __init__(self, case, random):
        self.case, self.random = case, random
        self.names = random.sample(sorted(SENSORS), random.choice((2, 2, 3)))
        self.sims, self.stopped = {}, set()
        self.lives = {}  # of each distance
        self.next_mm = random.randrange(600, 3000)
        for name in self.names:
            self.plug(name)

    def words(self):
        return [f'{name}={SENSORS[name][0]}@{self.case.path(name)}' for name in self.names]

    def plug(self, name):
        sensor, has_crc = SENSORS[name]
        self.next_mm += 1
        self.lives[self.next_mm] = Life(name, None)
        damage = ''
        if has_crc and self.random.random() < 0.5:
            damage = f'--fault {self.random.choice(DAMAGE)}=0.1 --seed {self.random.randrange(1000)}'
        self.sims[name] = self.case.sim(f'{sensor} --distance {self.next_mm} {damage}',
                                        ['--link', self.case.path(name)])
        self.sims[name].mm = self.next_mm

    def unplug(self, name):
        """By SIGKILL, as a cable that is pulled."""
        sim = self.sims[name]
        sim.end(signal.SIGKILL)
        self.stopped.discard(name)
        self.lives[sim.mm] = Life(name, time.monotonic())

    def stop(self, name):
        self.sims[name].send(signal.SIGSTOP)
        self.stopped.add(name)

    def go_on(self):
        for name in self.stopped:
            self.sims[name].send(signal.SIGCONT)
        self.stopped.clear()

    def happens(self, reader):
        """One thing, and how many seconds until the next."""
        name, random = self.random.choice(self.names), self.random
        what = random.choice(('unplug', 'unplug', 'stop', 'stop the reader', 'nothing'))
        if what == 'unplug':
            self.unplug(name)
            reader.hear(lambda: False, random.uniform(0.05, 0.6))
            self.plug(name)
        elif what == 'stop' and name not in self.stopped:
            self.stop(name)
            reader.hear(lambda: False, random.uniform(0.02, 0.9))
            self.go_on()
        elif what == 'stop the reader' and not reader.has_ended():
            reader.send(signal.SIGSTOP)
            time.sleep(random.uniform(0.02, 0.9))
            if random.random() < 0.3:
                self.unplug(name)
                self.plug(name)
            reader.send(signal.SIGCONT)
        return random.uniform(0, 0.3)


def rows_of(text, is_json):
    """Of csv or json, each with its time in seconds; a row that is not whole is wrong."""
    import csv
    import json
    if text and not text.endswith('\n'):
        raise Wrong(f'half a row: {text[-200:]!r}')
    lines = text.splitlines()
    if is_json:
        return [json.loads(line) for line in lines]
    header, *lines = lines or ['']
    rows = list(csv.DictReader(lines, header.split(','), restkey='more', restval='MISSING'))
    for row, line in zip(rows, lines):
        if 'more' in row or 'MISSING' in row.values():
            raise Wrong(f'no whole row: {line!r}')
    return rows


def check(rows, site, began, is_one_run=True):
    """No reading of another sensor or of one that was gone; times and sequence numbers only rise in a run."""
    times, sequences = {}, {}  # of each sensor
    for row in rows:
        at = int(row['time_us']) / 1e6
        if is_one_run and at < times.get(row['name'], 0):
            raise Wrong(f'a time that goes back: {row}')
        times[row['name']] = at
        if row['status'] != 'target':
            if row['status'] not in (*e2e.FAILURES,):
                raise Wrong(f'a status that no simulated sensor has: {row}')
            continue
        life = site.lives.get(int(row['distance_mm']))
        if life is None or life.name != row['name']:
            raise Wrong(f'a wrong reading: {row} of {site.lives}')
        if is_one_run and life.killed is not None and began + at > life.killed + LATE:
            raise Wrong(f'a reading of what was gone for {began + at - life.killed:.2f} s: {row}')
        if is_one_run:
            if int(row['sequence']) < sequences.get(row['name'], 0):
                raise Wrong(f'a sequence number that goes back: {row}')
            sequences[row['name']] = int(row['sequence'])
    return sum(row['status'] == 'target' for row in rows)


def descriptors(program):
    return len(os.listdir(f'/proc/{program.process.pid}/fd'))
