#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against fathom sim with each of its faults: no wrong reading, and an end in time.

The target stands still, so that a reading is right or wrong by its value alone. Each kind hits the second
frame alone, and, where a wrong reading cannot pass the checksum by chance, a third of all. Which bytes are
hit follows from the seed."""
import concurrent.futures
import re

import e2e

# What is simulated, how it is read, what stands before the probes, how long a response is waited for.
SUBJECTS = {
    'a16': ('a16', [1234], 700),
    'a16::modbus': ('a16 --mode modbus', [1234], 700),
    'a05': ('a05', [1000, 2000, 1953, 3562], 900),
    'a05::modbus': ('a05 --mode modbus', [1000, 2000, 1953, 3562], 600),
    'a05::dyp': ('a05 --mode dyp', [1000, 2000, 1953, 3562], 400),
    'hps167s': ('hps167s', [1234], 300),
}
FRAMES = 4
# The longest run takes 6 s on an idle machine: every attempt waits for its time-out and for the quarantine, twice that;
# late responses and a power cycle 2 s.
SECONDS = 60

# What the device itself says instead of a distance.
SAYS = {'no-target': 'no_target', 'interference': 'no_target', 'fault': 'fault'}
# Kinds that an 8-bit sum lets pass once in 256 in a frame that is hit, so that only the one frame is hit.
BY_CHANCE = {'insert', 'trailing', 'noise', 'unasked', 'split', 'power-cycle', 'truncate', 'drop', 'overrun',
             'break'}


class ReadFaults(e2e.Case):
    def run_one(self, device, kind, chance):
        line, distances, timeout = SUBJECTS[device]
        sim = self.sim(f'{device} --distance {",".join(map(str, distances))} --seed 7 --fault '
                       f'{kind}={chance}')
        done = self.run_fathom(f'read {line} --port {sim} --count {FRAMES} --timeout {timeout} --format csv '
                               '--stats', seconds=SECONDS)
        sim.end()
        return done

    def check(self, device, kind, done):
        distances = SUBJECTS[device][1]
        self.assertIn(done.code, (0, 1), done)
        for row in done.rows:
            if row['status'] == 'target':
                self.assertEqual(int(row['distance_mm']), distances[int(row['probe']) - 1], row)
            else:
                self.assertEqual(row['status'], SAYS.get(kind), row)
        counted = re.search(r'attempts (\d+), failed (\d+), readings (\d+)', done.err).groups()
        attempts, failed, readings = map(int, counted)
        self.assertEqual(readings, len(done.rows), done)
        self.assertEqual((attempts, failed != 0), (FRAMES, done.code != 0), done)
        # each attempt that did not fail gave every probe
        self.assertGreaterEqual(readings, (attempts - failed) * len(distances), done)

    @e2e.each(**{f'{subject.replace("::", "_")}_with_each_kind_at_{name}': (subject, chance)
                 for subject in SUBJECTS
                 for name, chance in (('the_second_frame', '1@2'), ('a_third_of_the_frames', '0.3'))})
    def faults(self, device, chance):
        has_crc = device in ('a16::modbus', 'a05::modbus', 'hps167s')
        skipped = BY_CHANCE if chance == '0.3' and not has_crc else ()
        listed = self.run_fathom(f'sim {device} --fault "?"').err
        kinds = re.search(r'one of ([a-z, -]+)', listed)[1].split(', ')
        self.assertGreaterEqual(len(kinds), 20, listed)
        with concurrent.futures.ThreadPoolExecutor(len(kinds)) as pool:
            runs = {kind: pool.submit(self.run_one, device, kind, chance) for kind in kinds
                    if kind not in skipped}
        for kind, run in runs.items():
            with self.subTest(device=device, kind=kind, chance=chance):
                self.check(device, kind, run.result())


if __name__ == '__main__':
    e2e.main(at_once=2)  # each runs some twenty pairs
