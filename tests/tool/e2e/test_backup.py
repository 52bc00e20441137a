#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom save and fathom restore with a real port and real files."""
import os
import signal

import e2e


class Backup(e2e.Case):
    def text(self, name):
        with open(self.path(name), encoding='ascii') as file:
            return file.read()

    def save(self, sensor, sim, name, code=0, *said, **options):
        return self.ends(f'save {sensor} --port {sim} --file {self.path(name)}', code, *said, **options)

    def restore(self, sensor, sim, name, more='', code=0, *said, **options):
        return self.ends(f'restore {sensor} --port {sim} --file {self.path(name)} {more}', code, *said, **options).out

    def change(self, name, old, new):
        text = self.text(name)
        self.assertEqual(text.count(old), 1)
        with open(self.path(name), 'w', encoding='ascii') as file:
            file.write(text.replace(old, new))

    def writes(self, sim):
        return [one['writes'] for one in sim.end(signal.SIGINT).told]

    def test_a_unit_is_saved_and_restored(self):
        sim = self.sim('hps167s:7 --counters')
        self.save('hps167s:7', sim, 'unit')
        self.assertEqual(os.listdir(self.folder), ['unit'])
        self.assertIn('\nwarm-up = 0  ', self.text('unit'))
        self.assertIn('no differences', self.restore('hps167s:7', sim, 'unit', '--dry-run'))
        self.change('unit', 'warm-up = 0  ', 'warm-up = 12 ')
        self.assertIn('0 s            -> 12 s', self.restore('hps167s:7', sim, 'unit', '--dry-run', code=1))
        self.assertIn('warm-up is 12 s (was 0)', self.restore('hps167s:7', sim, 'unit'))
        self.assertIn('no differences', self.restore('hps167s:7', sim, 'unit'))
        self.assertEqual(self.writes(sim), [1])

    def test_a_file_that_is_there_is_refused_and_a_text_goes_to_the_standard_output(self):
        sim = self.sim('a16:1:modbus')
        self.save('a16', sim, 'unit')
        before = self.text('unit')
        self.save('a16', sim, 'unit', 1, 'exists and is not overwritten', out='')
        self.assertEqual(self.text('unit'), before)
        # but for the time of the third line
        out = self.ends(f'save a16 --port {sim}', 0).out
        self.assertEqual(out.splitlines()[2:], before.splitlines()[2:])

    def test_a_new_unit_takes_the_place(self):
        old = self.sim('hps167s:7')
        self.ends(f'set hps167s:7 --port {old} baud 57600', 0)
        self.ends(f'save hps167s:7 --baud 57600 --port {old} --file {self.path("unit")}', 0)
        new = self.sim('hps167s --counters')
        self.assertIn('hps167s:7: responds at the new place, 57600 8E1', self.restore('hps167s', new, 'unit', '--as-new'))
        self.assertEqual(len(self.read_json(f'hps167s:7 --baud 57600 --port {new} --count 1')), 1)
        self.assertEqual(self.writes(new), [2])

    def test_an_output_that_is_full_is_an_error_and_leaves_no_file(self):
        sim = self.sim('a05:1:modbus')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'save a05 --port {sim}', 1, 'cannot write the output', stdout=full)
        os.mkdir(self.path('closed'), 0o555)
        if os.getuid() != 0:  # whom nothing is closed to
            self.save('a05', sim, 'closed/unit', 1, 'Permission denied')
        self.assertEqual(os.listdir(self.path('closed')), [])

    def test_nothing_is_written_where_the_difference_cannot_be_shown(self):
        sim = self.sim('a16:1:modbus --counters')
        self.save('a16', sim, 'unit')
        self.change('unit', 'switch-threshold = 1000', 'switch-threshold = 2000')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'restore a16 --port {sim} --file {self.path("unit")}', 1, 'cannot write the output',
                      stdout=full)
        self.assertEqual(self.writes(sim), [0])


if __name__ == '__main__':
    e2e.main()
