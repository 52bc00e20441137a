#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read --alarm and --until-alarm at a real port: what ends it, and with which exit status."""
import os
import signal

import e2e

ALARM = 'near<500/600,unknown=off,no-response=on'


class Alarm(e2e.Case):
    def begin(self, port, options='--until-alarm'):
        return self.fathom(f'read a16 --mode modbus --port {port} --timeout 400', options,
                           ['--alarm', f'{ALARM},unknown-after=700'])

    def test_until_alarm_ends_with_3_when_the_port_is_lost_and_waited_for(self):
        port = self.path('port')
        device = self.device()
        os.symlink(device.port, port)
        reader = self.begin(port, '--until-alarm --reconnect')
        device.asked(e2e.ASK_A16, e2e.registers(1, 700))
        reader.expect('alarm off, 700 mm')
        os.unlink(port)
        device.hang_up()
        self.assertRegex(self.ends(reader, 3, 'Waiting').out, r'a16: alarm no_response \(on\)\n$')

    def test_a_port_that_is_lost_is_no_response_of_any_sensor(self):
        """Also of those that have just responded."""
        sim = self.sim('a16:1:modbus a16:2:modbus --distance 700', ['--link', self.path('line')])
        reader = self.fathom(f'read a16:1 a16:2 --reconnect --port {self.path("line")}',
                             ['--alarm', f'{ALARM},unknown-after=2500'])
        for sensor in ('a16:1', 'a16:2'):
            reader.expect(f'{sensor}: alarm off, 700 mm')
        sim.end(signal.SIGKILL)
        for sensor in ('a16:1', 'a16:2'):
            reader.expect(rf'{sensor}: alarm no_response \(on\)')
        self.assertNotIn('not known', reader.end(signal.SIGINT).out)

    def test_a_port_that_never_comes_is_no_response_too(self):
        done = self.ends(self.begin(self.path('none'), '--until-alarm --reconnect --format csv'), 3)
        self.assertEqual([(row['address'], row['alarm'], row['is_on']) for row in done.rows],
                         [('1', 'no_response', 'true')])


if __name__ == '__main__':
    e2e.main()
