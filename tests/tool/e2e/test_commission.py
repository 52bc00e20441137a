#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom commission on a real pseudo terminal with a real record, and fathom sim --one-by-one."""
import os
import signal

import e2e

FIRST = '00390025423457142034383501060705'  # HPS-167S #3: the example; the further ones count up from it


class Commission(e2e.Case):
    def setUp(self):
        super().setUp()
        self.record = self.path('record.txt')

    def commission(self, sim, *line):
        return self.fathom('commission', *line, ['--port', sim.port, '--record', self.record])

    def units(self):
        """The lines of the record, without the date."""
        with open(self.record, encoding='ascii') as file:
            return [line.split()[:4] for line in file if not line.startswith('#')]

    def counters(self, sim):
        return self.ends(sim.end(signal.SIGINT), 0).told

    def test_three_units_one_by_one_interrupted_and_taken_up_again(self):
        sim = self.sim('hps167s hps167s hps167s --one-by-one --counters --distance 1234')
        first = self.commission(sim, 'hps167s --addresses 2-4')
        first.expect('writes termination off')
        first.expect('writes address 2')
        self.ends(first.end(signal.SIGINT), 1)
        self.assertEqual(self.units(), [['hps167s', '2', FIRST, 'planned']])
        second = self.commission(sim, 'hps167s --addresses 2-4')
        second.expect('address 2 is done: termination off from the next power-on, 1234 mm', seconds=60)
        sim.expect('sensor 2 is connected', 'err')
        second.expect('writes address 3', seconds=60)
        second.expect('address 3 is done')
        self.ends(second.end(signal.SIGINT), 1)
        self.assertIn('1 of 3' if 'address 3 is not done' in second.done.out else '2 of 3', second.done.out)
        done = self.commission(sim, 'hps167s --addresses 2-4').finish(60)
        self.ends(done, 0)
        self.assertIn('3 of 3 addresses are assigned and verified\n', done.out)
        self.assertEqual(self.units(), [['hps167s', str(2 + i), f'{FIRST[:-1]}{5 + i}', 'done'] for i in range(3)])
        self.assertEqual(os.listdir(self.folder), ['record.txt'])  # nothing of the way it is written is left
        counters = self.counters(sim)
        self.assertEqual([one['address'] for one in counters], [2, 3, 4])
        self.assertEqual([one['flash_writes'] for one in counters], [2, 2, 1])


class OneByOne(e2e.Case):
    def test_the_next_device_is_connected_when_the_one_before_has_left_its_address(self):
        sim = self.sim('a16:1:modbus,distance=1000 a16:1:modbus,distance=2000 --one-by-one')
        self.assertEqual(self.read_json(f'a16:1:modbus --count 1 --port {sim}')[0]['distance_mm'], 1000)
        self.ends(f'set a16:1 address 5 --port {sim}', 0)
        sim.expect('fathom: sensor 2 is connected', 'err')
        self.assertEqual(self.read_json(f'a16:1:modbus --count 1 --port {sim}')[0]['distance_mm'], 2000)
        self.assertEqual(self.read_json(f'a16:5:modbus --count 1 --port {sim}')[0]['distance_mm'], 1000)


if __name__ == '__main__':
    e2e.main()
