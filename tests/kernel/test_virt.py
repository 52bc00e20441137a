#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""port/posix on a PL011 and port/gpio on a PL061, by Debian's cloud-arm64 kernel on QEMU's `virt`. The console is on a PCI
card, so that the PL011 is free."""
import re
import threading
import time

import guest
import pins

# What a HPS-167S is asked for a measurement, and what it says: 2083 mm (tables 17 and 18).
ASK = bytes.fromhex('01 03 00 08 00 04 C5 CB')
SAYS_2083 = bytes.fromhex('01 03 08 08 23 DC B2 07 01 00 00 FD 41')

# ARM DDI 0183, table 3-1, and the bits of UARTLCR_H and UARTCR.
DR, IBRD, FBRD, LCR_H, CR = 0x00, 0x24, 0x28, 0x2C, 0x30
BREAK, PARITY, EVEN, TWO_STOP_BITS, EIGHT_BITS = 1, 2, 4, 8, 0x60
RTS = 0x800
CLOCK_HZ = 24000000  # virt's

ECHO, TRIGGER = 5, 6  # lines of the PL061


class Virt(guest.Guest):
    def __init__(self):
        super().__init__('arm64', 'aarch64-linux-gnu-gcc', ['virt', 'virt_uart', 'virt_pins', 'tty'],
                         ['qemu-system-aarch64', '-M', 'virt', '-cpu', 'cortex-a53', '-m', '256'], 'console=ttyS0')
        self.command += ['-device', 'pci-serial,chardev=console', '-serial', 'chardev:wire',
                         '-chardev', f'socket,id=wire,path={self.path("wire")},server=on,wait=off',
                         '-trace', 'pl011_write', '-qtest', f'unix:{self.path("qtest")}', '-qtest-log', '/dev/null']
        self.pins = pins.Pins(self.path('qtest'))
        self.began = 0, 0  # of listening, in the trace and of the outputs

    def begin(self):
        device, = (one['name'] for one in self.order('qom-list', path='/machine/unattached')
                   if one['type'] == 'child<pl061>')
        self.pins.begin(f'/machine/unattached/{device}')
        wire = self.connect('wire')

        def live():
            heard = b''
            while True:
                try:
                    some = wire.recv(100)
                except OSError:
                    return
                if not some:
                    return
                heard = (heard + some)[-len(ASK):]
                if heard == ASK:
                    wire.sendall(SAYS_2083)
        threading.Thread(target=live, daemon=True).start()

    def writes(self):
        """To the PL011: (seconds, register, value)."""
        for seconds, text in self.trace():
            found = re.match(r'pl011_write addr 0x(\w+) value 0x(\w+)', text)
            if found is not None:
                yield seconds, int(found[1], 16), int(found[2], 16)

    def registers(self):
        return {register: value for _, register, value in self.writes()}

    def do_chip(self, baud, parity, stop_bits):
        """Does it have these settings?"""
        now = self.registers()
        real = CLOCK_HZ * 4 / (64 * now[IBRD] + now[FBRD])
        bits = {'N': 0, 'E': PARITY | EVEN, 'O': PARITY}[parity] | EIGHT_BITS | (TWO_STOP_BITS if stop_bits == '2' else 0)
        frame = now[LCR_H] & (PARITY | EVEN | TWO_STOP_BITS | EIGHT_BITS)
        return int(abs(real / int(baud) - 1) < 0.01 and frame == bits)

    def do_is_in_break(self):
        return self.registers()[LCR_H] & BREAK

    def do_listen(self):
        self.began = len(list(self.writes())), len(self.pins.seen)
        return 'done'

    def do_turned(self, level, before_ms, after_ms):
        """Was RTS so while the bytes that were sent since then left, and the other way otherwise?"""
        writes = list(self.writes())
        rts = next(value for _, register, value in reversed(writes[:self.began[0]]) if register == CR) & RTS
        sending = 0 if level == 'on' else RTS
        idle = RTS - sending
        rows = []  # (seconds, RTS, is a byte)
        for seconds, register, value in writes[self.began[0]:]:
            if register == CR:
                rts = value & RTS
            if register in (CR, DR):
                rows.append((seconds, rts, register == DR))
        sent = [row for row in rows if row[2]]
        assert len(sent) == 5, rows
        assert all(row[1] == sending for row in sent), rows
        turned = next(row[0] for row in rows if row[1] == sending)
        back = next(row[0] for row in rows if row[0] >= sent[-1][0] and row[1] == idle)
        # No earlier, and not much later.
        assert -0.001 <= sent[0][0] - turned - int(before_ms) / 1000 < 0.1, rows
        assert -0.001 <= back - sent[-1][0] - int(after_ms) / 1000 < 0.1, rows
        return 'done'

    def do_set(self, line, level):
        self.pins.set(line, level)
        return 'done'

    def do_level(self, line):
        time.sleep(0.02)  # it comes by another way than the question
        return self.pins.levels[int(line)]

    def do_bounce(self, line, level):
        self.pins.bounce(line, int(level))
        return self.do_set(line, level)

    def do_a16(self, kind, width_ms):
        self.pins.trigger = TRIGGER
        self.pins.a16(ECHO, kind, int(width_ms) / 1000)
        return 'done'

    def do_width(self):
        """Of the last pulse of the A16, in us."""
        time.sleep(0.01)
        return self.pins.width_us

    def do_pulses(self, count, low_ms, high_ms):
        """The echo, which is high, goes low and high again so often. Returns the width of the widest of them, in us."""
        widest = 0
        for _ in range(int(count)):
            self.pins.set(ECHO, 0)
            time.sleep(int(low_ms) / 1000)
            self.pins.set(ECHO, 1)
            began = time.monotonic()
            time.sleep(int(high_ms) / 1000)
            widest = max(widest, time.monotonic() - began)
        return round(1e6 * widest)

    def do_triggered(self, count):
        """Was the A16 triggered so often, each for 2 ms and 220 ms after the one before? The times are the host's."""
        edges = [(at, level) for at, line, level in self.pins.seen[self.began[1]:] if line == TRIGGER]
        falls = [at for at, level in edges if level == 0]
        assert len(falls) >= int(count), edges
        assert all(later - at > 0.215 for at, later in zip(falls, falls[1:])), edges
        lows = [later - at for (at, level), (later, _) in zip(edges, edges[1:]) if level == 0]
        assert all(low > 0.001 for low in lows), lows
        return 'done'


guest.main(Virt)
