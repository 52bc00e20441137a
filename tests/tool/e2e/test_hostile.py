#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read of sensors that send by themselves and misbehave: whatever comes, no wrong reading is printed,
the run ends in its time, and exit status and message say what it was. What is asked is in
interop/test_servers_raw.py, frames out of step are in unit/test_stream_damage.c. It needs real time: CTest runs one such file at a time."""
import random

import e2e

VALUES = {'a16': (1953,), 'a05': (1000, 2000, 1953, 3562)}


class Sending(e2e.Case):
    """A16 and A05 frames with a mistake in each; one frame in 60 ms, so that pauses can be seen."""

    def stream(self, sensor, blocks, count=4, pause=0.06, timeout=3000):
        """Plays the blocks over and over until the reader has made its attempts."""
        device, reader = self.beside(f'read {sensor} --count {count} --timeout {timeout} --format csv --stats')
        at = 0
        while not reader.has_ended(pause):
            device.write(blocks[at % len(blocks)])
            at += 1
        self.assertLess(reader.done.elapsed, e2e.PATIENCE + count * max(timeout / 1000, 4 * pause * len(blocks)))
        return reader.done

    def shown(self, done, values):
        """How many readings there are: of nothing but these, each from its own probe."""
        got = [(int(row['probe']), int(row['distance_mm'])) for row in done.rows]
        for probe, mm in got:
            self.assertEqual(mm, values[probe - 1], got)
        return len(got)

    @e2e.each(
        a_flipped_bit=lambda frame: frame[:1] + bytes([frame[1] ^ 4]) + frame[2:],
        a_dropped_byte=lambda frame: frame[:2] + frame[3:],
        an_added_byte=lambda frame: frame[:2] + b'\x33' + frame[2:],
        a_truncated_frame=lambda frame: frame[:-1])
    def corrupted(self, corrupt):
        """A corrupted frame, a good one, and so on: the good ones are shown. Only corrupted ones: nothing is, and
        it is told."""
        for sensor, values in VALUES.items():
            good = e2e.frame(*values)
            done = self.stream(sensor, [corrupt(good), good])
            self.assertEqual((self.shown(done, values), done.code), (4 * len(values), 0), done)
            self.assertRegex(done.err, r'stream: frames \d+, ')
            done = self.stream(sensor, [corrupt(good)], count=1, timeout=500)
            self.assertEqual((self.shown(done, values), done.code), (0, 1), done)
            self.assertIn(': the bytes form no frame of', done.err)

    @e2e.each(**{f'a_stuck_line_{byte:02X}': byte for byte in (0x00, 0xFF, 0x55)})
    def stuck(self, byte):
        for sensor in VALUES:
            done = self.stream(sensor, [bytes([byte]) * 20], count=1, timeout=500)
            self.assertEqual(done.rows, [])
            self.ends(done, 1, ': the bytes ')

    def test_a_sensor_that_falls_silent_is_not_shown_again(self):
        for sensor, values in VALUES.items():
            device, reader = self.beside(f'read {sensor} --count 6 --timeout 150 --format csv')
            while len(reader.lines()) < 1 + len(values):
                device.write(e2e.frame(*values))
                reader.has_ended(0.06)
            done = self.ends(reader, 1, ': no byte was received. Earlier readings were good')
            self.assertLess(self.shown(done, values), 6 * len(values))

    def test_random_bytes_between_good_frames(self):
        noise = random.Random(7)
        for sensor, values in VALUES.items():
            good = e2e.frame(*values)
            blocks = [block for _ in range(8)
                      for block in (bytes(noise.randrange(255) for _ in range(noise.randrange(1, 30))), good)]
            done = self.stream(sensor, blocks, count=8)
            self.assertEqual((self.shown(done, values), done.code), (8 * len(values), 0), done)


if __name__ == '__main__':
    e2e.main()
