#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom calibrate on a pseudo terminal: a simulated HPS-167S that is 15 mm off measures what is true afterwards."""
import signal

import e2e


class Calibrate(e2e.Case):
    def flash_writes(self, sim):
        return sim.end(signal.SIGINT).told[0]['flash_writes']

    @e2e.each(
        # 10 mm off, and 5 more by an old offset: -15, after which 5 are missing; -10
        a_device_that_replaces_is_made_right=('--distance 2010', 2, 'offset: -10 mm; flash writes: 2; #12 replaces'),
        a_device_that_adds_is_made_right=('--distance 2010 --with offset-adds', 1,
                                          'offset: -15 mm or the old offset minus 15 mm; flash writes: 1'))
    def made_right(self, device, writes, said):
        sim = self.sim(f'hps167s:7 {device} --counters')
        self.ends(f'set hps167s:7 --port {sim} distance-offset 5', 0)
        done = self.ends(f'calibrate hps167s:7 --port {sim} --known 2000 --samples 5', 0)
        self.assertIn(f'known 2000 mm; {said}', done.out)
        self.assertEqual(done.out.count('to flash'), writes)
        self.assertEqual(self.read_json(f'hps167s:7 --port {sim} --count 1')[0]['distance_mm'], 2000)
        self.assertEqual(self.flash_writes(sim), writes + 1)  # one by set

    def test_what_cannot_be_announced_is_not_written(self):
        sim = self.sim('hps167s --distance 2015 --counters')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'calibrate hps167s --port {sim} --known 2000', 1, 'cannot write the output; flash writes: 0',
                      stdout=full)
        self.assertEqual(self.flash_writes(sim), 0)

    def test_a_dead_line_is_explained(self):
        self.ends(f'calibrate hps167s --port {self.device()} --known 2000 --timeout 100', 1,
                  'no byte was received', 'nothing was written', out='')


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
