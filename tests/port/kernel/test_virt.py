#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""port/posix on a PL011 and port/gpio on a PL061, by Debian's cloud-arm64 kernel on QEMU's `virt`. The console is on a
PCI card, so that the PL011 is free."""
import re
import statistics
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
        super().__init__('arm64', 'aarch64-linux-gnu-gcc', ['virt_uart', 'virt_pins', 'tty'],
                         ['qemu-system-aarch64', '-M', 'virt', '-cpu', 'cortex-a53', '-m', '256'], 'console=ttyS0')
        self.command += ['-device', 'pci-serial,chardev=console', '-serial', 'chardev:wire',
                         '-chardev', f'socket,id=wire,path={self.path("wire")},server=on,wait=off',
                         '-trace', 'pl011_write', '-trace', 'pl061_set_output', '-trace', 'pl061_input_change',
                         '-qtest', f'unix:{self.path("qtest")}', '-qtest-log', '/dev/null']
        self.pins = pins.Pins(self.path('qtest'))
        self.began = 0  # of listening, in the trace

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

    @staticmethod
    def writes(rows):
        """To the PL011: (seconds, register, value)."""
        for seconds, text in rows:
            found = re.match(r'pl011_write addr 0x(\w+) value 0x(\w+)', text)
            if found is not None:
                yield seconds, int(found[1], 16), int(found[2], 16)

    def registers(self):
        return {register: value for _, register, value in self.writes(self.trace())}

    def edges(self, pattern, line, began=None):
        """Of a line, since listening began: (seconds, level)."""
        for seconds, text in self.trace()[self.began if began is None else began:]:
            found = re.search(pattern + r' (\d) (?:changed )?to (\d)', text)
            if found is not None and int(found[1]) == line:
                yield seconds, int(found[2])

    def do_chip(self, baud, parity, stop_bits):
        """Does it have these settings?"""
        now = self.registers()
        real = CLOCK_HZ * 4 / (64 * now[IBRD] + now[FBRD])
        bits = EIGHT_BITS | {'N': 0, 'E': PARITY | EVEN, 'O': PARITY}[parity] | {'1': 0, '2': TWO_STOP_BITS}[stop_bits]
        frame = now[LCR_H] & (PARITY | EVEN | TWO_STOP_BITS | EIGHT_BITS)
        return int(abs(real / int(baud) - 1) < 0.01 and frame == bits)

    def do_is_in_break(self):
        return self.registers()[LCR_H] & BREAK

    def do_listen(self):
        self.began = len(self.trace())
        return 'done'

    def do_turned(self, level, before_ms, after_ms):
        """Was RTS so while the bytes that were sent since then left, and the other way otherwise?"""
        rows = self.trace()
        rts = [value for _, register, value in self.writes(rows[:self.began]) if register == CR][-1] & RTS
        sending = 0 if level == 'on' else RTS
        idle = RTS - sending
        seen = []  # (seconds, RTS, is a byte)
        for seconds, register, value in self.writes(rows[self.began:]):
            if register == CR:
                rts = value & RTS
            if register in (CR, DR):
                seen.append((seconds, rts, register == DR))
        sent = [row for row in seen if row[2]]
        assert len(sent) == 5, seen
        assert all(row[1] == sending for row in sent), seen
        turned = next(row[0] for row in seen if row[1] == sending)
        back = next(row[0] for row in seen if row[0] >= sent[-1][0] and row[1] == idle)
        # No earlier; how much later is up to the machine that all of this runs on.
        assert sent[0][0] - turned > int(before_ms) / 1000 - 0.001, seen
        assert back - sent[-1][0] > int(after_ms) / 1000 - 0.001, seen
        return 'done'

    def do_set(self, line, level):
        self.pins.set(line, level)
        return 'done'

    def do_level(self, line):
        """Of an output."""
        return [level for _, level in self.edges('output', int(line), 0)][-1]

    def do_bounce(self, line, level):
        self.pins.bounce(line, int(level))
        return self.do_set(line, level)

    def do_a16(self, kind, width_ms):
        self.pins.trigger = TRIGGER
        self.pins.a16(ECHO, kind, int(width_ms) / 1000)
        return 'done'

    def do_width(self, seen_us):
        """Of the pulse of the echo in the last cycle that was most like the one that was seen, in us. A busy machine
        makes a long pulse of a bounce."""
        last = max((at for at, level in self.edges('output', TRIGGER) if level == 0), default=0)
        edges = [edge for edge in self.edges('input', ECHO) if edge[0] > last]
        widths = [1e6 * (later - at) for (at, level), (later, _) in zip(edges, edges[1:]) if level == 1]
        return round(min(widths, key=lambda width: abs(width - int(seen_us))))

    def do_pulses(self, count, low_ms, high_ms):
        """The echo, which is high, goes low and high again so often."""
        for _ in range(int(count)):
            self.pins.set(ECHO, 0)
            time.sleep(int(low_ms) / 1000)
            self.pins.set(ECHO, 1)
            time.sleep(int(high_ms) / 1000)
        return 'done'

    def do_triggered(self, count):
        """Was the A16 triggered so often, each time for 2 ms, and 220 ms after the one before? A guest may be stopped
        on its way to a pin, by a busy machine: of the times, the one in the middle."""
        edges = list(self.edges('output', TRIGGER))
        falls = [at for at, level in edges if level == 0]
        assert len(falls) >= int(count), edges
        lows = [later - at for (at, level), (later, _) in zip(edges, edges[1:]) if level == 0]
        cycles = [later - at for at, later in zip(falls, falls[1:])]
        assert statistics.median(lows) >= 0.002, lows
        assert statistics.median(cycles) >= 0.22, cycles
        return 'done'


guest.main(Virt)
