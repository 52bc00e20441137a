#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom save and fathom restore with a real port and real files."""
import os
import signal

import e2e


class Backup(e2e.Case):
    def on(self, command, sensor, sim, more='', code=0, *said, **options):
        return self.ends(f'{command} {sensor} --port {sim} --file {self.path("unit")} {more}', code, *said, **options).out

    def change(self, old, new):
        with open(self.path('unit'), encoding='ascii') as file:
            text = file.read()
        self.assertEqual(text.count(old), 1)
        with open(self.path('unit'), 'w', encoding='ascii') as file:
            file.write(text.replace(old, new))
        return text

    def writes(self, sim):
        return [one['writes'] for one in sim.end(signal.SIGINT).told]

    def test_a_unit_is_saved_and_restored(self):
        sim = self.sim('hps167s:7 --counters')
        self.on('save', 'hps167s:7', sim)
        self.assertEqual(os.listdir(self.folder), ['unit'])
        self.assertIn('no differences', self.on('restore', 'hps167s:7', sim, '--dry-run'))
        # the text goes to the standard output without --file; the time is in its third line
        out = self.ends(f'save hps167s:7 --port {sim}', 0).out
        before = self.change('warm-up = 0  ', 'warm-up = 12 ')
        self.assertEqual(out.splitlines()[2:], before.splitlines()[2:])
        self.assertIn('0 s            -> 12 s', self.on('restore', 'hps167s:7', sim, '--dry-run', 1))
        self.assertIn('warm-up is 12 s (was 0)', self.on('restore', 'hps167s:7', sim))
        self.assertIn('no differences', self.on('restore', 'hps167s:7', sim))
        self.assertEqual(self.writes(sim), [1])

    def test_an_output_that_is_full_leaves_no_file_and_writes_nothing(self):
        sim = self.sim('a16:1:modbus --counters')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'save a16 --port {sim}', 1, 'cannot write the output', stdout=full)
            os.mkdir(self.path('closed'), 0o555)
            if os.getuid() != 0:  # whom nothing is closed to
                self.ends(f'save a16 --port {sim} --file {self.path("closed/unit")}', 1, 'Permission denied')
            self.assertEqual(os.listdir(self.path('closed')), [])
            self.on('save', 'a16', sim)
            self.change('switch-threshold = 1000', 'switch-threshold = 2000')
            self.on('restore', 'a16', sim, '', 1, 'cannot write the output', stdout=full)
        self.assertEqual(self.writes(sim), [0])


if __name__ == '__main__':
    e2e.main()
