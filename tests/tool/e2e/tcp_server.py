# SPDX-License-Identifier: MIT
"""A TCP server that says what the test says, byte for byte."""
import os
import select
import socket
import struct
import termios
import threading
import time
import tty

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


class Gateway(threading.Thread):
    """A Modbus TCP gateway before a line, the port of a `fathom sim`; is_raw: a converter that passes raw bytes, each
    response of the line in two pieces that are `pieces` seconds apart. It serves one connection at a time, and closes
    it after `frames` responses (0: never) or `idle` seconds without one; is_reset: by RST."""
    def __init__(self, line, baud, is_raw=False, pieces=0, frames=0, idle=3600, is_reset=False):
        super().__init__(daemon=True)
        self.server, self.is_raw, self.pieces = Server(backlog=5), is_raw, pieces
        self.frames, self.idle, self.is_reset = frames, idle, is_reset
        self.connections, self.functions, self.ended = 0, [], False
        self.line = os.open(str(line), os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.line)
        settings = termios.tcgetattr(self.line)
        settings[4] = settings[5] = getattr(termios, f'B{baud}')
        termios.tcsetattr(self.line, termios.TCSANOW, settings)
        self.start()

    def __str__(self):
        return ('rtu-' if self.is_raw else '') + str(self.server)

    def close(self):
        self.ended = True
        self.join(e2e.PATIENCE)
        self.server.close()
        os.close(self.line)

    def run(self):
        while not self.ended:
            if not e2e.is_ready(self.server.socket, 0.05):
                continue
            self.server.accept()
            self.connections += 1
            try:
                self.serve(self.server.client)
            except OSError:  # the tool has ended
                pass
            (self.server.reset if self.is_reset else self.server.hang_up)()

    def serve(self, client):
        frames, heard, header, last = 0, b'', b'', time.monotonic()
        while not self.ended and time.monotonic() - last < self.idle and not (self.frames and frames >= self.frames):
            ready = select.select([client, self.line], [], [], 0.02)[0]
            if client in ready:
                request = client.recv(512)
                if not request:
                    return
                last, heard = time.monotonic(), b''
                if not self.is_raw:
                    header, request = request[:4], request[6:]
                    request += e2e.crc16(request)
                self.functions.append(request[1])
                os.write(self.line, request)
            if self.line in ready:
                time.sleep(0.01)  # the rest of the frame
                part = os.read(self.line, 512)
                heard += part
                if self.is_raw:
                    client.sendall(part[:3])
                    time.sleep(self.pieces)
                    client.sendall(part[3:])
                    frames += 1
                elif e2e.crc16(heard[:-2]) == heard[-2:]:
                    client.sendall(header + struct.pack('>H', len(heard) - 2) + heard[:-2])
                    frames += 1
                last = time.monotonic()


class Case(e2e.Case):
    def gateway(self, sensors, baud=9600, **options):
        gateway = Gateway(self.sim(sensors), baud, **options)
        self.addCleanup(gateway.close)
        return gateway

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
