#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What fathom publish costs with 256 lines, each read twice a second, beside a Mosquitto and a mosquitto_sub.

    publish.py BUILD                 all of it, a minute and a half; BUILD: the build folder, with fathom and tests/bench/bench_far_end
    publish.py BUILD --soak SECONDS  memory alone, 64 lines as fast as they can: so many messages as 256 lines have in longer
    publish.py BUILD --try           a moment with 16 lines: does it work?
    publish.py --self-test           shows that this can fail

It is measured while the broker is there; while it has stopped without a word; while its port refuses; and while it comes back,
which has all that has waited told at once. In each of them: CPU of one processor, memory, and how much later than the interval
a reading came. A figure over its bound fails."""
import argparse
import collections
import contextlib
import datetime
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

import report

sys.path[:0] = [os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'tool', 'e2e')]

INTERVAL_MS = 500
SOAK_MS, SOAK_LINES = 20, 64
GROWTH_KIB = 256
CPU, MEMORY_KIB, LATE_MS = 0.10, 20 * 1024, INTERVAL_MS
FIRST_MM, RESPONSES = 1000, 16  # of a line, as lines/lines.h has them
WARM_S = 4


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
            stream.append({**state, 'time': seconds_of(state['time'])})
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
        return f'{self.name:34} {self.seconds:3.0f} s {self.cpu * 100:5.1f} % {self.memory / 1024:6.1f} MiB {self.late_ms:7.1f} ms' \
            + ''.join(f'  OVER: {what}' for what in self.over())


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
                  'max_queued_messages 0', 'persistence true', f'persistence_location {self.folder}/', sep='\n', file=file)
        return self.start('mosquitto', '-c', self.path('broker.conf'), stderr=subprocess.DEVNULL)

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
        time.sleep(0.5)
        with open(self.path('told'), 'w', encoding='utf-8') as told:
            self.start('mosquitto_sub', '-h', '127.0.0.1', '-p', self.number, '-F', '%q', '-t', 'fathom/bench/+/state', stdout=told,
                       stderr=subprocess.DEVNULL)
            self.publisher = self.start(os.path.join(self.build, 'fathom'), 'publish', self.path('site.yaml'))
            time.sleep(WARM_S)
            begin = memory_kib(self.publisher.pid, 'VmRSS')
            self.measure('soak', seconds)
            end = memory_kib(self.publisher.pid, 'VmRSS')
        return os.path.getsize(self.path('told')) // 2, begin, end

    def run(self, seconds):
        self.config(self.far_end())
        broker = self.broker()
        with open(self.path('told'), 'w', encoding='utf-8') as told, open(self.path('log'), 'w', encoding='utf-8') as log:
            subscriber = ['mosquitto_sub', '-h', '127.0.0.1', '-p', self.number, '-q', 1, '-c', '-i', 'bench', '-F', '%t %p',
                          '-t', 'fathom/bench/+/state']
            time.sleep(0.5)
            self.start(*subscriber, stdout=told, stderr=log)
            self.publisher = self.start(os.path.join(self.build, 'fathom'), 'publish', self.path('site.yaml'), stderr=log)
            time.sleep(WARM_S)
            self.measure('the broker is there', seconds)
            broker.send_signal(signal.SIGSTOP)
            self.measure('the broker has stopped', seconds / 2)
            broker.send_signal(signal.SIGCONT)
            self.measure('it goes on', seconds / 2)
            broker.terminate()  # it keeps the subscription
            broker.wait()
            self.measure('its port refuses', seconds / 2)
            broker = self.broker()
            time.sleep(0.2)
            self.measure('it is there again', seconds)
            time.sleep(1)
            self.publisher.terminate()
            self.publisher.wait()
            time.sleep(0.5)
        with open(self.path('told'), encoding='utf-8') as told:
            streams = states_of(told)
        check_states(streams, self.count)
        for row in self.rows:
            row.late_ms = latest_ms(streams, row.begin, row.end)
        return streams


def rate_of(streams):
    """Messages a second, at most, in any second in which the broker got them."""
    seconds = collections.Counter(int(state['time'] + state['age_ms'] / 1000) for states in streams.values() for state in states)
    return max(seconds.values())


def self_test():
    def state(seq, at, **more):
        return {'seq': seq, 'status': 'target', 'distance_mm': 1000, 'dropped': 0, 'time': at, **more}
    right = [state(number, number * 0.5) for number in range(1, 21)]

    def fails(states, count=1):
        try:
            check_states({'s0': states}, count)
        except Failed:
            return True
        return False
    late = Row('late', 10)
    late.late_ms = LATE_MS
    text = 'fathom/bench/s0/state {"time":"1970-01-01T00:00:01.500000Z","seq":1}'
    seen = {
        'right': not fails(right),
        'one is missing': fails(right[:4] + right[5:]),
        'another line': fails([state(1, 0.5, distance_mm=1016)]),
        'a failure': fails([state(1, 0.5, status='no_response')]),
        'a sensor is missing': fails(right, count=2),
        'on time': latest_ms({'s0': right}, 0, 10.5) == 0,
        'late': latest_ms({'s0': right[:4] + right[5:]}, 0, 10.5) == 500,
        'over': late.over() == ['late'] and Row('none', 1).over() == [],
        'a time': states_of([text, text]) == {'s0': [{'time': 1.5, 'seq': 1}]},
    }
    return report.judge(seen)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('build', metavar='BUILD', nargs='?')
    parser.add_argument('--lines', type=int, default=256)
    parser.add_argument('--seconds', type=float, default=20)
    parser.add_argument('--soak', type=float, metavar='SECONDS', help='memory alone')
    parser.add_argument('--try', dest='is_tried', action='store_true', help='a moment with 16 lines')
    parser.add_argument('--self-test', action='store_true', help='show that this can fail')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if options.build is None:
        parser.error('BUILD is missing: a build folder')
    if options.soak is not None:
        with contextlib.ExitStack() as stack:
            messages, begin, end = Bench(options.build, SOAK_LINES, stack).soak(options.soak)
        hours = messages / (256 * 1000 / INTERVAL_MS * 3600)
        print(f'{messages} messages, as many as 256 lines have in {hours:.2f} hours; memory {begin} KiB at the begin, {end} at the end')
        return 1 if end > begin + GROWTH_KIB else 0
    count, seconds = (16, 4) if options.is_tried else (options.lines, options.seconds)
    try:
        with contextlib.ExitStack() as stack:
            bench = Bench(options.build, count, stack)
            streams = bench.run(seconds)
    except Failed as why:
        print(why, file=sys.stderr)
        return 1
    print(f'{count} lines, each {INTERVAL_MS} ms; {sum(map(len, streams.values()))} readings, none missing; '
          f'up to {rate_of(streams)} messages a second')
    print(f'{"":34} {"":5} {"CPU":>7} {"memory":>10} {"late":>10}')
    print(*bench.rows, sep='\n')
    # With a few lines of a busy machine the figures say little.
    return 1 if any(row.over() for row in bench.rows) and not options.is_tried else 0


if __name__ == '__main__':
    sys.exit(main())
