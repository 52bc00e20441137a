#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom publish under load, while its broker, its connection and it itself are killed and begun again.

    broker.py [--kills 100] [--seed N]     three minutes; --kills 8 is the quick form, 20 s

FATHOM is the tool, as for tests/tool/e2e; Mosquitto and its mosquitto_sub have to be there. Between records all that the tool
has sent, and what each broker has acknowledged. At the end: what was acknowledged has come to the subscriber; nothing that was
sent is missing but what a kill has left unacknowledged, 16 messages at most; the order is kept; and what is missing in the numbers
is what was counted as dropped, and published. The last line is "N passed, M failed"."""
import argparse
import collections
import contextlib
import json
import os
import random
import select
import signal
import socket
import sys
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(os.path.dirname(HERE), 'e2e')]
import e2e  # noqa: E402: from there
import mqtt  # noqa: E402

LINES, INTERVAL_MS, QUEUE = 4, 40, 50  # of the queue: a quarter of a second of all lines' messages
UNDER_WAY = 16  # messages that are not acknowledged yet, at most
LONGEST_PAUSE_S = 70  # 60, and what a busy machine takes
TOLD_S = 1.5  # so soon the tool tells that more was dropped: a second, and what a busy machine takes
PUBLISH, PUBACK = 3, 4


class Wrong(Exception):
    pass


# ---- between the publisher and its broker ----

class Sent:
    """A message that a publisher has sent to a broker: the numbers of the broker and of the connection, whether the broker has
    acknowledged it, and when it was sent, in seconds."""

    def __init__(self, topic, payload, broker, connection):
        self.topic, self.payload, self.broker, self.connection = topic, payload, broker, connection
        self.is_acknowledged, self.at = False, time.monotonic()

    def __repr__(self):
        return f'{self.topic} {self.payload}{" acknowledged" if self.is_acknowledged else ""}'


def packets(data):
    """The whole packets at its begin, (type, body), and the rest. MQTT 3.1.1, 2.2."""
    found = []
    while True:
        length, at = 0, 1
        while at < len(data) and at < 5:
            length |= (data[at] & 127) << 7 * (at - 1)
            at += 1
            if not data[at - 1] & 128:
                break
        else:
            return found, data
        if len(data) < at + length:
            return found, data
        found.append((data[0], data[at:at + length]))
        data = data[at + length:]


class Between:
    """Lets through what a publisher and its broker say, and records what is published and what the broker acknowledges. The
    connection can be cut at any moment, and the broker be another one after that."""

    def __init__(self):
        self.listener = socket.socket()
        self.listener.bind(('127.0.0.1', 0))
        self.listener.listen()
        self.number = self.listener.getsockname()[1]
        self.sent = []  # each time that it was: again too
        self.target = None  # (the broker's number, its port); None: a client that comes is sent away
        self.lock = threading.Lock()
        self.is_over = False
        self.connections = 0
        self.sockets = ()
        threading.Thread(target=self._serve, daemon=True).start()

    def end(self):
        self.is_over = True
        self.cut()
        with contextlib.suppress(OSError):
            self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def cut(self):
        for one in self.sockets:
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def count(self):
        with self.lock:
            return len(self.sent)

    def _serve(self):
        while not self.is_over:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            target = self.target
            with contextlib.suppress(OSError), client:
                if target is not None:
                    with socket.create_connection(('127.0.0.1', target[1])) as broker:
                        for one in (client, broker):
                            one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                        self.sockets = (client, broker)
                        self.connections += 1
                        self._pass(client, broker, target[0])

    def _pass(self, client, broker, number):
        rest = {client: b'', broker: b''}
        waiting = {}  # by packet identifier
        while True:
            for one in select.select([client, broker], [], [])[0]:
                data = one.recv(65536)
                if not data:
                    return
                found, rest[one] = packets(rest[one] + data)
                for first, body in found:
                    if one is client and first >> 4 == PUBLISH:
                        self._note(first, body, number, waiting)
                    if one is broker and first >> 4 == PUBACK:
                        with self.lock:
                            waiting.pop(body[:2]).is_acknowledged = True
                # Recorded before the other one has it: what has reached a subscriber stands there.
                (broker if one is client else client).sendall(data)

    def _note(self, first, body, number, waiting):
        end = 2 + int.from_bytes(body[:2], 'big')
        assert first >> 1 & 3 == 1, 'QoS 1'
        one = Sent(body[2:end].decode(), body[end + 2:].decode(), number, self.connections)
        waiting[body[end:end + 2]] = one
        with self.lock:
            self.sent.append(one)


# ---- what is right ----

def state_of(payload):
    """Of a message with a number: what it says. Else None."""
    one = json.loads(payload) if payload.startswith('{') else {}
    return one if 'seq' in one else None


def firsts(messages):
    """Each state's first time, {(boot, topic): [state, ...]}."""
    streams, known = collections.defaultdict(list), set()
    for topic, payload in messages:
        state = state_of(payload)
        if state is None or (state['boot'], topic, state['seq']) in known:
            continue
        known.add((state['boot'], topic, state['seq']))
        streams[state['boot'], topic].append(state)
    return streams


def check_order(messages, what):
    """Returns the streams."""
    streams = firsts(messages)
    for (_, topic), states in streams.items():
        numbers = [state['seq'] for state in states]
        if numbers != sorted(numbers):
            raise Wrong(f'{what}: {topic}: not in order: {numbers}')
    return streams


def check_gaps(streams):
    """What is missing in the numbers of a topic and a start is what each state says was dropped before it."""
    for (_, topic), states in streams.items():
        for number, state in enumerate(states, 1):
            if state['seq'] != number + state['dropped']:
                raise Wrong(f'{topic}: message {number} has the number {state["seq"]}, {state["dropped"]} were dropped')


def check_acknowledged(sent):
    """Of each start all is acknowledged, at the first or at a later time, but the last messages, so many as may be under way."""
    acknowledged = {(one.topic, key_of(one)) for one in sent if one.is_acknowledged}
    by_boot = collections.defaultdict(list)
    for one in sent:
        state = state_of(one.payload)
        if state is not None:
            by_boot[state['boot']].append(one)
    for boot, messages in by_boot.items():
        lost = [one for one in messages if (one.topic, key_of(one)) not in acknowledged]
        last = list(dict.fromkeys((one.topic, key_of(one)) for one in reversed(messages)))[:UNDER_WAY]
        if {(one.topic, key_of(one)) for one in lost} - set(last):
            raise Wrong(f'boot {boot}: sent, never acknowledged, and not the last: {lost}')


def key_of(one):
    state = state_of(one.payload)
    return (state['boot'], state['seq']) if state else one.payload


def check_received(sent, received):
    """received: by the broker's number."""
    count = 0
    for one in sent:
        if not one.is_acknowledged or state_of(one.payload) is None:
            continue
        count += 1
        if (one.topic, one.payload) not in received[one.broker]:
            raise Wrong(f'broker {one.broker} has acknowledged {one}, which has not come to its subscriber')
    return count


def check_counters(sent):
    """Of each start: the sum of what its topics say is what it says of itself. It says it at most TOLD_S after a connection was
    made or a message was dropped, so a start that ended sooner is left out.
    (how many could be compared, how many messages were dropped in all that is known)"""
    starts, checked, count = collections.defaultdict(list), 0, 0
    for one in sent:
        if one.payload.startswith('{'):
            told = json.loads(one.payload)
            if 'boot' in told:
                starts[told['boot']].append((one, told))
    for boot, messages in starts.items():
        last = messages[-1][0]
        before, after, total = {}, {}, None
        for one, told in messages:
            if one.topic.endswith('/publisher'):
                total = told['dropped']
            elif 'seq' in told:
                after[one.topic] = told['dropped']
                if one.connection == last.connection and one.at + TOLD_S <= last.at:
                    before[one.topic] = told['dropped']
        count += sum(after.values())
        if before != after:
            continue
        checked += 1
        if sum(after.values()) != total:
            raise Wrong(f'boot {boot}: {total} were dropped, it says; its topics say {after}')
    return checked, count


def check(sent, received):
    """(messages acknowledged, starts whose counters could be compared, messages dropped)"""
    check_gaps(check_order([(one.topic, one.payload) for one in sent], 'sent'))
    for number, messages in received.items():
        check_order(messages, f'received from broker {number}')
    check_acknowledged(sent)
    return (check_received(sent, {number: set(messages) for number, messages in received.items()}), *check_counters(sent))


class Run(mqtt.Case):
    def __init__(self, kills, seed):
        super().__init__('runTest')
        self.kills, self.random = kills, random.Random(seed)
        self.brokers, self.received = 0, {}

    def begin_broker(self):
        """With a subscriber, before a publisher comes to it: of QoS 0, so that no message waits in the broker for another one's
        acknowledgement, and none of those is lost with it, for which the system would take back what it has sent."""
        self.number = mqtt.free_port()
        self.mosquitto = self.broker('max_queued_messages 0', 'set_tcp_nodelay true')
        self.brokers += 1
        self.subscriber = self.subscribe(qos=0)
        self.between.target = (self.brokers, self.number)

    def end_broker(self, how):
        """What it has handed over is in the subscriber's socket."""
        self.between.target = None
        self.mosquitto.end(how)
        self.between.cut()
        heard = -1
        while heard != len(self.subscriber.said['out']):
            heard = len(self.subscriber.said['out'])
            self.subscriber.hear(lambda: False, 0.2)
        self.subscriber.end()
        self.received[self.brokers] = [(one.topic, one.payload) for one in self.messages(self.subscriber)]

    def begin_tool(self):
        self.tool = self.publish(self.site)
        self.starts += 1

    def sleep(self, seconds):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if self.tool.has_ended(0.02):
                raise Wrong(f'it has ended: {self.tool.done}')
            self.subscriber.hear(lambda: False, 0.001)

    def happens(self):
        what = self.random.choice(('broker', 'broker', 'tool', 'tool', 'both', 'connection'))
        how = self.random.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM))
        if what == 'connection':
            self.between.cut()
        if what in ('broker', 'both'):
            self.end_broker(how)
        if what in ('tool', 'both'):
            self.tool.end(how)
            self.begin_tool()
        if what in ('broker', 'both'):
            self.sleep(self.random.choice((0, 0.1, 1.2)))
            self.begin_broker()
        return what

    def publishes_again(self):
        """The pause before it connects has grown if it was cut off often."""
        before = self.between.count()
        self.sleep(self.random.uniform(0.05, 0.4))
        deadline = time.monotonic() + LONGEST_PAUSE_S
        while self.between.count() <= before + 5:
            self.sleep(0.05)
            if time.monotonic() >= deadline:
                raise Wrong(f'it does not publish again: {self.tool.said}')

    def runTest(self):
        self.between = Between()
        self.addCleanup(self.between.end)
        lines = []
        for line in range(LINES):
            self.sim(f'hps167s:7 --link {self.path(f"bus{line}")}')
            lines.append(self.line(self.path(f'bus{line}'), f's{line} hps167s:7 level: {{mounting: 9000, height: 9000, capacity: 1}}'))
        self.number, self.starts = self.between.number, 0
        self.site = self.config(*lines, top=f'interval: {INTERVAL_MS}\nqueue: {{messages: {QUEUE}}}\ndiscovery: off')
        self.begin_broker()
        self.begin_tool()
        self.told = collections.Counter()
        for _ in range(self.kills):
            self.publishes_again()
            if self.random.random() < 0.3:
                self.sleep(TOLD_S + 0.5)  # so that it has told all of its counters
            self.told[self.happens()] += 1
        self.publishes_again()
        self.sleep(TOLD_S + 1)
        self.tool.end(signal.SIGTERM)
        self.end_broker(signal.SIGTERM)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n\n')[0])
    parser.add_argument('--kills', type=int, default=100)
    parser.add_argument('--seed', default='1')
    options = parser.parse_args()
    run = Run(options.kills, options.seed)
    began = time.monotonic()
    wrong = e2e.run(run)
    if not wrong:
        try:
            acknowledged, compared, dropped = check(run.between.sent, run.received)
            print(f'{dict(run.told)}; {run.starts} starts, {run.brokers} brokers, {time.monotonic() - began:.0f} s: '
                  f'{len(run.between.sent)} messages sent, {acknowledged} states acknowledged and all of them received, '
                  f'{dropped} dropped and all of them told; counters of {compared} starts compared')
            if dropped == 0 or compared == 0:
                wrong = ['nothing was dropped, or no counters could be compared: more kills show it']
        except Wrong as why:
            wrong = [str(why)]
    print(*wrong, sep='\n')
    print(f'{int(not wrong)} passed, {int(bool(wrong))} failed')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
