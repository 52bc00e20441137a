#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tool at devices of the second simulation (tests/devices/second), each of which has made its own choices, on pseudo
terminals and in real time: what it says against what the device did."""
import os

import e2e

SECOND_PTY = os.path.join(os.environ.get('FATHOM_BUILD') or os.path.join(e2e.ROOT, 'build'), 'tests', 'tool', 'second_pty')

# kind of device, sensor and mode, setting and value, register, value there
KINDS = [('a16', 'a16:1:modbus', 'switch-threshold 2000', 0x0206, 2000),
         ('a05', 'a05:1:modbus', 'address 7', 0x0200, 7),
         ('hps167s', 'hps167s', 'warm-up 3', 0x0A, 3),
         ('a16-rs232', 'a16:1:modbus', 'switch-threshold 2000', 0x0206, 2000)]


class Second(e2e.Case):
    @e2e.each(**{f'what_is_said_is_what_happened_{kind[0]}_{seed}': (seed, *kind)
                 for seed in range(1, 21) for kind in [KINDS[seed % len(KINDS)]]})
    def what_is_said(self, seed, kind, sensor, change, register, value):
        device = self.start([SECOND_PTY, kind, seed])
        device.port = device.expect(r'^(/dev/pts/\d+)$')[1]
        read = self.run_fathom(f'read {sensor} --count 4 --format json --port {device}')
        # Where the machine stops the device for a moment its response comes in two parts, and is damaged: that is said.
        info = next((done for done in (self.run_fathom(f'info {sensor} --format json --port {device}')
                                       for _ in range(3)) if done.code == 0 or 'damaged' not in done.err), None)
        self.assertIsNotNone(info)
        done = self.run_fathom(f'set {sensor} {change} --port {device}')
        did = [line.split() for line in device.end().out.splitlines()[1:]]
        sent = {int(words[1]) for words in did if words[0] == 'sent'}
        for reading in read.json:
            self.assertIn(reading['raw'], sent, read)
            if reading['status'] == 'target':
                self.assertEqual(reading['distance_mm'], reading['raw'], read)
        self.assertEqual(len(info.json), 1, info)
        taken = [int(words[2]) for words in did if words[0] == 'set' and int(words[1]) == register]
        if 'not written' in done.err or 'unchanged' in done.out:
            self.assertEqual(taken, [], done)
        elif done.code == 0:
            self.assertEqual(taken, [value], done)
        else:
            self.assertRegex(done.err, 'not confirmed|differs|refused', done)


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
