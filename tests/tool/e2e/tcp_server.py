# SPDX-License-Identifier: MIT
"""A TCP server that says what the test says, byte for byte."""
import socket
import struct

import e2e


class Server:
    """Listens on the loopback interface, at a port that the system has chosen (or that one); as text it is
    what the tool takes for --port. Without a backlog it keeps the port, and nothing listens there."""

    def __init__(self, backlog=1, family=socket.AF_INET, number=0):
        self.socket = socket.socket(family)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(('127.0.0.1' if family == socket.AF_INET else '::1', number))
        if backlog is not None:
            self.socket.listen(backlog)
        self.number = self.socket.getsockname()[1]
        self.host = '127.0.0.1' if family == socket.AF_INET else '[::1]'
        self.client = None

    def __str__(self):
        return f'tcp:{self.host}:{self.number}'

    def accept(self):
        if not e2e.is_ready(self.socket, e2e.PATIENCE):
            raise AssertionError('no client connects')
        self.client = self.socket.accept()[0]
        self.client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def request(self):
        """Its transaction, its unit, and what follows the unit: five bytes."""
        request = e2e.read_exactly(12, self.client, self.client.recv)
        return int.from_bytes(request[:2], 'big'), request[6], request[7:]

    def say(self, *parts):
        self.client.sendall(b''.join(bytes(part) for part in parts))

    def reset(self):
        """Without a farewell."""
        self.client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
        self.hang_up()

    def hang_up(self):
        if self.client is not None:
            self.client.close()
            self.client = None

    def close(self):
        self.hang_up()
        self.socket.close()


class Case(e2e.Case):
    def server(self, **options):
        server = Server(**options)
        self.addCleanup(server.close)
        return server

    def full(self):
        """A server whose queue is full: what connects now hears nothing."""
        server = self.server(backlog=0)
        for _ in range(4):
            waiting = socket.socket()
            self.addCleanup(waiting.close)
            waiting.setblocking(False)
            waiting.connect_ex(('127.0.0.1', server.number))
        return str(server)


def adu(transaction, unit, *pdu):
    """MODBUS Messaging on TCP/IP V1.0b, 3.1.3."""
    return struct.pack('>HHHB', transaction, 0, len(pdu) + 1, unit) + bytes(pdu)


def registers(transaction, unit, *values):
    """The response to a read."""
    return adu(transaction, unit, 3, 2 * len(values), *struct.pack(f'>{len(values)}H', *values))
