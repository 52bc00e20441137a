#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""port/posix on a PL011, by Debian's cloud-arm64 kernel on QEMU's `virt`. The console is on a PCI card, so that the PL011
is free."""
import re
import threading

import guest

# What a HPS-167S is asked for a measurement, and what it says: 2083 mm (tables 17 and 18).
ASK = bytes.fromhex('01 03 00 08 00 04 C5 CB')
SAYS_2083 = bytes.fromhex('01 03 08 08 23 DC B2 07 01 00 00 FD 41')

# ARM DDI 0183, table 3-1, and the bits of UARTLCR_H and UARTCR.
DR, IBRD, FBRD, LCR_H, CR = 0x00, 0x24, 0x28, 0x2C, 0x30
BREAK, PARITY, EVEN, TWO_STOP_BITS, EIGHT_BITS = 1, 2, 4, 8, 0x60
RTS = 0x800
CLOCK_HZ = 24000000  # virt's


class Virt(guest.Guest):
    def __init__(self):
        super().__init__('arm64', 'aarch64-linux-gnu-gcc', ['virt', 'virt_uart', 'tty'],
                         ['qemu-system-aarch64', '-M', 'virt', '-cpu', 'cortex-a53', '-m', '256'], 'console=ttyS0')
        self.command += ['-device', 'pci-serial,chardev=console', '-serial', 'chardev:wire',
                         '-chardev', f'socket,id=wire,path={self.path("wire")},server=on,wait=off',
                         '-trace', 'pl011_write']
        self.began = 0  # of listening, in the trace

    def begin(self):
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
        self.began = len(list(self.writes()))
        return 'done'

    def do_turned(self, level, before_ms, after_ms):
        """Was RTS so while the bytes that were sent since then left, and the other way otherwise?"""
        writes = list(self.writes())
        rts = next(value for _, register, value in reversed(writes[:self.began]) if register == CR) & RTS
        sending = 0 if level == 'on' else RTS
        idle = RTS - sending
        rows = []  # (seconds, RTS, is a byte)
        for seconds, register, value in writes[self.began:]:
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


guest.main(Virt)
