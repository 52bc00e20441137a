# SPDX-License-Identifier: MIT
"""Stands between a publisher and its broker: lets through what both say, and records what is published and what the broker
acknowledges. The connection can be cut at any moment, and the broker be another one after that."""
import contextlib
import select
import socket
import threading
import time

PUBLISH, PUBACK = 3, 4


class Sent:
    """A message that a publisher has sent to a broker: the broker's number, whether it has acknowledged it, and when it was
    sent, in seconds."""

    def __init__(self, topic, payload, broker, at):
        self.topic, self.payload, self.broker, self.is_acknowledged, self.at = topic, payload, broker, False, at

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
    def __init__(self):
        self.listener = socket.socket()
        self.listener.bind(('127.0.0.1', 0))
        self.listener.listen()
        self.number = self.listener.getsockname()[1]
        self.sent = []  # each time that it was: again too
        self.target = None  # (the broker's number, its port); None: a client that comes is sent away
        self.lock = threading.Lock()
        self.is_over = False
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
        one = Sent(body[2:end].decode(), body[end + 2:].decode(), number, time.monotonic())
        waiting[body[end:end + 2]] = one
        with self.lock:
            self.sent.append(one)
