#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what fathom publish costs with 256 lines, each read twice a second, beside a Mosquitto and a mosquitto_sub.

    publish.py BUILD                 measures everything: a minute and a half. BUILD is a build folder with fathom and
                                     tests/bench/bench_far_end
    publish.py BUILD --soak SECONDS  measures memory alone, with 64 lines that are read as fast as they can be
    publish.py BUILD --try           checks with 16 lines that no reading is lost; no figure can fail

The script measures while the broker is there; while the broker has stopped without a word; while its port refuses; and
while it comes back and gets all messages that have waited. In each of them it measures the CPU time of one processor,
the memory, and how much later than the interval a reading came. A figure over its bound fails."""
import argparse
import collections
import contextlib
import datetime
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'tool', 'e2e')]

INTERVAL_MS = 500
SOAK_MS, SOAK_LINES = 20, 64
GROWTH_KIB = 256
CPU, MEMORY_KIB, LATE_MS = 0.10, 20 * 1024, INTERVAL_MS
FIRST_MM, RESPONSES = 1000, 16  # of a line, as publish/far_end.c has them
WARM_S = 4
DEADLINE_S = 60  # of each step that waits for another program; on an idle machine a step takes less than 2 s


class Failed(Exception):
    pass


def cpu_s(pid):
    with open(f'/proc/{pid}/stat', encoding='ascii') as file:
        fields = file.read().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def memory_kib(pid, name):
    with open(f'/proc/{pid}/status', encoding='ascii') as file:
        return next(int(line.split()[1]) for line in file if line.startswith(name + ':'))


def seconds_of(text):
    return datetime.datetime.strptime(text, '%Y-%m-%dT%H:%M:%S.%fZ').replace(tzinfo=datetime.timezone.utc).timestamp()


def states_of(lines):
    """{name: [state, ...]}, each once and with its time in seconds."""
    streams = collections.defaultdict(list)
    for line in lines:
        topic, _, payload = line.partition(' ')
        if not topic.endswith('/state'):
            continue
        state = json.loads(payload)
        stream = streams[topic.split('/')[-2]]
        if not stream or state['seq'] > stream[-1]['seq']:
            stream.append({**state, 'time': seconds_of(state['utc'])})
    return streams


def check_states(streams, count):
    """Every line is there, none was mixed up with another one, and nothing is missing."""
    if len(streams) != count:
        raise Failed(f'{len(streams)} of {count} sensors have come')
    for name, states in streams.items():
        least = FIRST_MM + int(name[1:]) * RESPONSES
        for number, state in enumerate(states, states[0]['seq']):
            if state['status'] != 'target' or not least <= state['distance_mm'] < least + RESPONSES:
                raise Failed(f'{name}: {state}')
            if state['seq'] != number or state['dropped'] != 0:
                raise Failed(f'{name}: {state}, instead of {number}')


def latest_ms(streams, begin, end):
    """How much more than an interval was between two readings of a sensor, at most, in this time."""
    most = 0
    for states in streams.values():
        times = [state['time'] for state in states if begin <= state['time'] <= end]
        if len(times) < 2 or times[0] - begin > 2 * INTERVAL_MS / 1000 or end - times[-1] > 2 * INTERVAL_MS / 1000:
            raise Failed(f'{len(times)} readings in {end - begin:.0f} s')
        most = max(most, *(later - before for before, later in zip(times, times[1:])))
    return most * 1000 - INTERVAL_MS


class Row:
    def __init__(self, name, seconds):
        self.name, self.seconds = name, seconds
        self.cpu = self.memory = self.late_ms = 0.0
        self.begin = self.end = 0.0

    def over(self):
        """The bounds that it does not keep."""
        return [what for what, figure, bound in (('CPU', self.cpu, CPU), ('memory', self.memory, MEMORY_KIB),
                                                 ('late', self.late_ms, LATE_MS)) if figure >= bound]

    def __str__(self):
        return f'{self.name:34} {self.seconds:3.0f} s {self.cpu * 100:5.1f} % {self.memory / 1024:6.1f} MiB ' \
            f'{self.late_ms:7.1f} ms' + ''.join(f'  OVER: {what}' for what in self.over())


class Bench:
    def __init__(self, build, count, stack):
        import mqtt  # pylint: disable=import-outside-toplevel
        self.build, self.count, self.stack = build, count, stack
        self.folder = stack.enter_context(tempfile.TemporaryDirectory(prefix='fathom-bench-'))
        self.number = mqtt.free_port()
        self.rows = []

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *words, **options):
        program = subprocess.Popen([str(word) for word in words], **options)
        self.stack.callback(lambda: (program.kill(), program.wait()))
        return program

    def broker(self):
        with open(self.path('broker.conf'), 'w', encoding='ascii') as file:
            print('log_dest none', 'user root', f'listener {self.number} 127.0.0.1', 'allow_anonymous true',
                  'max_queued_messages 0', 'persistence true', f'persistence_location {self.folder}/', sep='\n',
                  file=file)
        broker = self.start('mosquitto', '-c', self.path('broker.conf'), stderr=subprocess.DEVNULL)
        self.wait_for('the broker', self.accepts)
        return broker

    @staticmethod
    def wait_for(what, is_so):
        deadline = time.monotonic() + DEADLINE_S
        while not is_so():
            if time.monotonic() > deadline:
                raise Failed(f'{what} did not come within {DEADLINE_S} s')
            time.sleep(0.05)

    def accepts(self):
        """Returns True if the broker accepts a connection."""
        with socket.socket() as client:
            return client.connect_ex(('127.0.0.1', self.number)) == 0

    def streams(self):
        """Returns the states that the subscriber has written, without a last line that is not complete."""
        with open(self.path('told'), encoding='utf-8') as told:
            return states_of(told.read().rpartition('\n')[0].splitlines())

    def has_all_after(self, since):
        """Returns True if every sensor has sent a reading that was made after this time."""
        streams = self.streams()
        return len(streams) == self.count and all(states[-1]['time'] > since for states in streams.values())

    def config(self, ports, interval_ms=INTERVAL_MS):
        with open(self.path('site.yaml'), 'w', encoding='ascii') as file:
            print(f'site: bench\ninterval: {interval_ms}\nqueue: {{messages: 20000, bytes: 8388608}}\n'
                  f'broker: {{host: 127.0.0.1, port: {self.number}}}\nlines:', file=file)
            for number, port in enumerate(ports):
                print(f'  - {{port: {port}, sensors: [{{name: s{number}, sensor: "hps167s:1"}}]}}', file=file)

    def measure(self, name, seconds):
        row = Row(name, seconds)
        row.begin, cpu = time.time(), cpu_s(self.publisher.pid)
        while time.time() < row.begin + seconds:
            if self.publisher.poll() is not None:
                raise Failed(f'fathom publish has ended with {self.publisher.returncode}')
            time.sleep(0.2)
        row.end = time.time()
        row.cpu = (cpu_s(self.publisher.pid) - cpu) / (row.end - row.begin)
        row.memory = memory_kib(self.publisher.pid, 'VmHWM')
        self.rows.append(row)

    def far_end(self):
        """The ports of the lines."""
        program = self.start(os.path.join(self.build, 'tests/bench/bench_far_end'), self.count, stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True)
        return [program.stdout.readline().strip() for _ in range(self.count)]

    def soak(self, seconds):
        """(messages, KiB at the begin, KiB at the end)"""
        self.config(self.far_end(), SOAK_MS)
        self.broker()
        with open(self.path('told'), 'w', encoding='utf-8') as told:
            self.start('mosquitto_sub', '-h', '127.0.0.1', '-p', self.number, '-F', '%q', '-t', 'fathom/bench/+/state',
                       stdout=told, stderr=subprocess.DEVNULL)
            self.publisher = self.start(os.path.join(self.build, 'fathom'), 'publish', self.path('site.yaml'))
            time.sleep(WARM_S)
            begin = memory_kib(self.publisher.pid, 'VmRSS')
            self.measure('soak', seconds)
            end = memory_kib(self.publisher.pid, 'VmRSS')
        return os.path.getsize(self.path('told')) // 2, begin, end

    def run(self, seconds, is_tried):
        self.config(self.far_end())
        broker = self.broker()
        with open(self.path('told'), 'w', encoding='utf-8') as told, \
                open(self.path('log'), 'w', encoding='utf-8') as log:
            subscriber = ['mosquitto_sub', '-h', '127.0.0.1', '-p', self.number, '-q', 1, '-c', '-i', 'bench',
                          '-F', '%t %p', '-t', 'fathom/bench/+/state']
            self.start(*subscriber, stdout=told, stderr=log)
            self.publisher = self.start(os.path.join(self.build, 'fathom'), 'publish', self.path('site.yaml'),
                                        stderr=log)
            self.wait_for('the first reading of each sensor', lambda: self.has_all_after(0))
            if not is_tried:
                time.sleep(WARM_S)
            self.measure('the broker is there', seconds)
            broker.send_signal(signal.SIGSTOP)
            self.measure('the broker has stopped', seconds / 2)
            broker.send_signal(signal.SIGCONT)
            self.measure('it goes on', seconds / 2)
            broker.terminate()  # it keeps the subscription
            broker.wait()
            self.measure('its port refuses', seconds / 2)
            self.broker()
            self.measure('it is there again', seconds)
            end = time.time()
            self.wait_for('the last reading of each sensor', lambda: self.has_all_after(end))
            self.publisher.terminate()
            self.publisher.wait()
        streams = self.streams()
        check_states(streams, self.count)
        for row in self.rows if not is_tried else ():
            row.late_ms = latest_ms(streams, row.begin, row.end)
        return streams


def rate_of(streams):
    """Messages a second, at most, in any second in which the broker got them."""
    seconds = collections.Counter(int(state['time'] + state['age_ms'] / 1000)
                                  for states in streams.values() for state in states)
    return max(seconds.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('build', metavar='BUILD', nargs='?')
    parser.add_argument('--lines', type=int, default=256)
    parser.add_argument('--seconds', type=float, default=20)
    parser.add_argument('--soak', type=float, metavar='SECONDS', help='memory alone')
    parser.add_argument('--try', dest='is_tried', action='store_true',
                        help='check with 16 lines that no reading is lost')
    options = parser.parse_args()
    if options.build is None:
        parser.error('BUILD is missing: a build folder')
    if options.soak is not None:
        with contextlib.ExitStack() as stack:
            messages, begin, end = Bench(options.build, SOAK_LINES, stack).soak(options.soak)
        hours = messages / (256 * 1000 / INTERVAL_MS * 3600)
        print(f'{messages} messages, as many as 256 lines have in {hours:.2f} hours; '
              f'memory {begin} KiB at the start, {end} KiB at the end')
        return 1 if end > begin + GROWTH_KIB else 0
    count, seconds = (16, 2) if options.is_tried else (options.lines, options.seconds)
    try:
        with contextlib.ExitStack() as stack:
            bench = Bench(options.build, count, stack)
            streams = bench.run(seconds, options.is_tried)
    except Failed as why:
        print(why, file=sys.stderr)
        return 1
    print(f'{count} lines, each {INTERVAL_MS} ms; {sum(map(len, streams.values()))} readings, none missing; '
          f'up to {rate_of(streams)} messages a second')
    if options.is_tried:  # the figures of a few lines on a busy machine mean little
        return 0
    print(f'{"":34} {"":5} {"CPU":>7} {"memory":>10} {"late":>10}')
    print(*bench.rows, sep='\n')
    return 1 if any(row.over() for row in bench.rows) else 0


if __name__ == '__main__':
    sys.exit(main())
