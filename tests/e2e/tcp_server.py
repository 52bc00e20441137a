# SPDX-License-Identifier: MIT
"""A TCP server that says what the test says, byte for byte."""
import select
import socket
import struct
import time

import e2e


class Server:
    """Listens on the loopback interface, at a port that the system has chosen."""

    def __init__(self, backlog=1, family=socket.AF_INET):
        self.socket = socket.socket(family)
        self.socket.bind(('127.0.0.1' if family == socket.AF_INET else '::1', 0))
        self.socket.listen(backlog)
        self.number = self.socket.getsockname()[1]
        self.path = f'tcp:127.0.0.1:{self.number}'
        self.client = None

    def accept(self):
        if not select.select([self.socket], [], [], e2e.PATIENCE)[0]:
            raise AssertionError('nobody connects')
        self.client = self.socket.accept()[0]
        self.client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def request(self, count=12, seconds=e2e.PATIENCE):
        """Exactly so many bytes."""
        deadline = time.monotonic() + seconds
        got = b''
        while len(got) < count:
            if not select.select([self.client], [], [], max(0, deadline - time.monotonic()))[0]:
                raise AssertionError(f'{count} bytes were expected, {got.hex(" ")} came')
            part = self.client.recv(count - len(got))
            if not part:
                raise AssertionError('the client has gone')
            got += part
        return got

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


def adu(transaction, unit, *pdu):
    """MODBUS Messaging on TCP/IP V1.0b, 3.1.3."""
    return struct.pack('>HHHB', transaction, 0, len(pdu) + 1, unit) + bytes(pdu)


def registers(transaction, unit, *values):
    """The answer to a read."""
    return adu(transaction, unit, 3, 2 * len(values), *struct.pack(f'>{len(values)}H', *values))
