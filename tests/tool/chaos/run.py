#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tool in a bad world, in real time: its sensors are killed, stopped and unplugged, it is stopped itself, its output
stalls or is closed, and the wall clock jumps.

    run.py [--rounds 30] [--seed N] [--at-once 4]     another seed, other rounds; one round: --only N

FATHOM is the tool, as for tests/tool/e2e. Each round is a kind of output (OUTPUTS), which says how it has to end. In all of
them: it does not hang, no reading is wrong or of a sensor that was gone, no row is half written, no descriptor is
lost. No two simulated sensors of a round, nor one before it was killed and after, measure the same distance; so each row
says by its distance who has answered, and until when that one lived. A round that fails is repeated once, alone; both
results are printed, and only the second counts. The last line is
"N passed, M failed"."""
import argparse
import collections
import concurrent.futures
import csv
import fcntl
import json
import os
import random
import signal
import sys
import time

sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'e2e')]
import e2e  # noqa: E402: from there

CLOCK = '/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1'
JUMPS = ('-3600', '-86400', '+7200', '-0.5', '+0')  # seconds, of the wall clock alone
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


class Round(e2e.Case):
    """One of them; the name of its output is a method."""

    def __init__(self, number, seed):
        super().__init__('runTest')
        self.random = random.Random(f'{seed}/{number}')
        self.kind = OUTPUTS[number % len(OUTPUTS)]
        self.number, self.tool = number, e2e.FATHOM
        self.readings = 0

    def id(self):
        return f'chaos.{self.number:4} {self.kind}'

    def runTest(self):
        self.site = Site(self, self.random)
        self.is_json = self.random.random() < 0.3
        getattr(self, self.kind)()

    def reader(self, *more, **options):
        """fathom read of all sensors."""
        self.began = time.monotonic()
        return self.start([self.tool, 'read', *self.site.words(), '--reconnect', '--interval', '60', '--format',
                           'json' if self.is_json else 'csv', *more], **options)

    def disturb(self, reader, seconds=HOLDS):
        until = time.monotonic() + seconds
        while time.monotonic() < until and not reader.has_ended(self.site.happens(reader)):
            pass

    def check(self, text, **options):
        self.readings += check(rows_of(text, self.is_json), self.site, self.began, **options)

    def ended(self, program, codes, words=''):
        done = program.finish()
        if done.code not in codes or words not in done.err:
            raise Wrong(f'it ended so: {done}')
        return done

    def each_is_read(self, read, reader):
        """Each of the sensors that live now, within the longest pause between two tries."""
        alive = {sim.mm for sim in self.site.sims.values()}

        def all_are():
            seen = {row['distance_mm'] for row in rows_of(read(), self.is_json)[-60:] if row['status'] == 'target'}
            return alive <= {int(mm) for mm in seen}
        deadline = time.monotonic() + BACK
        while not all_are():
            if reader.has_ended(0.1) or time.monotonic() > deadline:
                raise Wrong(f'not all of {alive} are read again: {read()[-1500:]}{reader.said["err"].decode()[-1500:]}')

    def goes_on(self, reader, read):
        """Through all of it, and with no more descriptors than at first; a signal ends it."""
        self.each_is_read(read, reader)
        before = descriptors(reader)
        self.disturb(reader)
        self.each_is_read(read, reader)
        after = descriptors(reader)
        if after != before:
            raise Wrong(f'{before} descriptors at first, {after} now')
        done = self.ended_by_signal(reader)
        if done.cpu > 0.25 * done.elapsed:
            raise Wrong(f'it spins: {done.cpu:.2f} s of CPU in {done.elapsed:.2f} s')

    def ended_by_signal(self, reader):
        reader.send(self.random.choice((signal.SIGINT, signal.SIGTERM, signal.SIGHUP)))
        return self.ended(reader, (0, 1))

    # ---- what its output is ----

    def pipe(self):
        reader = self.reader()

        def whole():
            text = reader.said['out'].decode()
            return text[:text.rfind('\n') + 1]
        self.goes_on(reader, whole)
        self.check(reader.done.out)

    def file(self, **options):
        log = self.path('log')
        reader = self.reader('--output', log, **options)

        def whole():
            if not os.path.exists(log):
                return ''
            with open(log, encoding='ascii') as file:
                return file.read()
        self.goes_on(reader, whole)
        self.check(whole())

    def file_while_the_wall_clock_jumps(self):
        clock = self.path('clock')

        def jump():
            with open(clock + '.new', 'w', encoding='ascii') as file:
                file.write(self.random.choice(JUMPS))
            os.replace(clock + '.new', clock)
        jump()
        happens = self.site.happens
        self.site.happens = lambda reader: (jump(), happens(reader))[1]
        self.file(env={**os.environ, 'LD_PRELOAD': CLOCK, 'FAKETIME_TIMESTAMP_FILE': clock, 'FAKETIME_NO_CACHE': '1',
                       'FAKETIME_DONT_FAKE_MONOTONIC': '1'})

    def pipe_that_is_closed(self):
        ours, theirs = os.pipe()
        with open(ours, 'rb') as pipe:
            reader = self.reader(stdout=theirs)
            os.close(theirs)
            text = b''.join(pipe.readline() for _ in range(self.random.randrange(1, 20)))
        self.check(text.decode())
        self.disturb(reader, e2e.PATIENCE)
        self.ended(reader, (0, 1))

    def pipe_that_stalls(self):
        """Nothing takes its rows for some seconds; then all that it has written is whole."""
        reader = self.reader()
        fcntl.fcntl(reader.process.stdout, fcntl.F_SETPIPE_SZ, 4096)  # rows of a second
        self.disturb(reader, 0.7)
        until = time.monotonic() + 2.5
        while time.monotonic() < until:
            name = self.random.choice(self.site.names)
            self.site.unplug(name)
            self.site.plug(name)
            time.sleep(0.2)
        self.ended_by_signal(reader)
        self.check(reader.done.out)

    def file_of_a_tool_that_is_killed(self):
        """By SIGKILL and begun again, to the same file."""
        log = self.path('log')
        for _ in range(3):
            reader = self.reader('--output', log)
            self.disturb(reader, self.random.uniform(0.02, 0.9))
            reader.end(signal.SIGKILL)
        reader = self.reader('--output', log, '--duration', '1')
        self.ended(reader, (0, 1))
        with open(log, encoding='ascii') as file:
            self.check(file.read(), is_one_run=False)

    def saved_settings(self):
        """The sensor or the tool dies meanwhile: a whole file or none."""
        name = self.site.names[0]
        self.site.unplug(name)
        sensor = 'hps167s:7'
        saved = self.path('saved')
        whole = self.path('whole')
        sim = self.sim(sensor)
        self.ended(self.start([self.tool, 'save', sensor, '--port', str(sim), '--file', whole]), (0,))
        save = self.start([self.tool, 'save', sensor, '--port', str(sim), '--file', saved])
        save.hear(lambda: False, self.random.uniform(0, 0.12))
        if self.random.random() < 0.5:
            sim.end(signal.SIGKILL)
            self.ended(save, (0, 1))
        else:
            save.end(signal.SIGKILL)
        if os.path.exists(saved) and self.settings_of(saved) != self.settings_of(whole):
            raise Wrong('half a file')

    def settings_of(self, path):
        with open(path, encoding='ascii') as file:
            return [line for line in file if not line.startswith('#')]


OUTPUTS = ('pipe', 'file', 'file_while_the_wall_clock_jumps', 'pipe_that_is_closed', 'file_of_a_tool_that_is_killed',
           'pipe_that_stalls', 'pipe', 'saved_settings')


def play(numbers, seed, at_once):
    """[(number, kind, what was wrong)] of the rounds."""
    def one(number):
        case = Round(number, seed)
        wrong = e2e.run(case)
        return number, case.kind, ''.join(wrong), case.readings
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        return list(pool.map(one, numbers))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n\n')[0])
    parser.add_argument('--rounds', type=int, default=30)
    parser.add_argument('--seed', default='1')
    parser.add_argument('--only', type=int)
    parser.add_argument('--at-once', type=int, default=4)
    options = parser.parse_args()
    e2e.follow_hang_up()
    for needed in (e2e.FATHOM, CLOCK):
        if not os.path.exists(needed):
            sys.exit(f'{needed} is not there')
    numbers = range(options.rounds) if options.only is None else [options.only]
    done = {number: row for number, *row in play(numbers, options.seed, options.at_once)}
    for number, (kind, wrong, _) in list(done.items()):
        if wrong:
            print(f'\nround {number}, {kind} (--seed {options.seed} --only {number}), is repeated alone:\n{wrong}')
            (_, *done[number]), = play([number], options.seed, 1)
    done = [(number, *row) for number, row in done.items()]
    of_each = collections.Counter(kind for _, kind, _, _ in done)
    print(*(f'{kind:34} {count:4} rounds' for kind, count in sorted(of_each.items())), sep='\n')
    print(f'{sum(readings for *_, readings in done)} readings, each of the right sensor and in its time')
    failed = [row for row in done if row[2]]
    for number, kind, wrong, _ in failed:
        print(f'\nround {number}, {kind} (--seed {options.seed} --only {number}):\n{wrong}')
    print(f'{len(done) - len(failed)} passed, {len(failed)} failed')
    return 1 if failed or not done else 0


if __name__ == '__main__':
    sys.exit(main())
