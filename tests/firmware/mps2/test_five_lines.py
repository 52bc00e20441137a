#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tests/firmware/mps2/images/five_lines.c on QEMU: five UARTs, five sensors, one loop."""
import os
import re
import select

import qemu
from qemu import e2e, interop

TANK, BUMPER, GATE, SILO, REAR = 1, 2, 4, 8, 16
ALL = 31
MOST = 9999  # readings: the image does not end by itself
MANY = 1000  # errors: nine programs on a machine that has other work too
SAID = {'tank': {'probe 1 754 mm'},
        'bumper': {'probe 1 1000 mm', 'probe 2 2000 mm', 'probe 3 1953 mm', 'probe 4 no target'},
        'gate': {'probe 1 2083 mm'}, 'silo': {'probe 1 511 mm'}, 'rear': {'probe 1 3562 mm'}}


class FiveLines(interop.PymodbusServer, qemu.Case):
    def libmodbus(self, line, first, values):
        server, client = self.two_ends()
        interop.LibmodbusServer.serve(self, server, line, 1, first, values)
        return client

    def pymodbus(self, line, first, values):
        server, client = self.two_ends()
        self.serve(server, line, 1, first, values)
        return client

    def far_ends(self):
        """Servers of others for two sensors, simulated sensors for three. 511 mm is FF 01 FF FF, of which one byte
        too few or too many makes 65281 mm with a right sum."""
        return {'tank': self.libmodbus((9600, 'none'), 0x0100, ['111', '754', '222']),
                'bumper': self.pymodbus((9600, 'none'), 0x0106, ['1000', '2000', '1953', '0xFFFD']),
                'gate': self.sim('hps167s', '--distance', '2083').port,
                'silo': self.sim('a16', '--distance', '511').port,
                'rear': self.sim('a05:1:dyp', '--distance', '3562,1,1,1').port}

    def five_lines(self, ports, count, which=ALL):
        return self.boot('five_lines', *(ports.get(name) for name in SAID), words=(count, which),
                         traces=('cmsdk_apb_uart_set_params',))

    def check_said(self, out, names, count):
        for name in names:
            readings = self.readings(out, name, MANY)
            self.assertEqual(set(readings), SAID[name], name)
            self.assertGreaterEqual(sum(words.startswith('probe 1 ') for words in readings), count, name)

    def test_one_loop_reads_five_sensors_in_five_ways(self):
        done = self.end_well(self.five_lines(self.far_ends(), 6))
        self.check_said(done.out, SAID, 6)
        # The simulated sensors answer at their own rate only, which a pseudo terminal keeps; the servers at any.
        # 25 MHz / 1302 is 19201.2.
        self.assertEqual(re.findall(r'params set to (.*)$', self.traced(done), re.M),
                         ['9600 8N1', '9600 8N1', '19201 8N1', '9600 8N1', '9600 8N1'])

    def test_more_responses_than_an_index_of_the_ring_can_count(self):
        """60 responses of 13 bytes."""
        ports = {'gate': self.libmodbus((19200, 'none'), 8, qemu.DATASHEET)}
        done = self.end_well(self.five_lines(ports, 60, GATE))
        self.assertEqual(self.readings(done.out, 'gate'), ['probe 1 2083 mm'] * 60)

    def none_answers(self, name, error):
        """On that line. The others go on after it was noticed, however slow this machine is."""
        ports = self.far_ends()
        ports[name] = self.device().port
        image = self.five_lines(ports, MOST)
        image.expect(rf'^{name} error {error}$', seconds=qemu.PATIENCE)
        before = len(image.lines())
        others = [other for other in SAID if other != name]

        def have_gone_on():
            said = image.lines()[before:]
            return all(any(line.startswith(f'{other} probe 1 ') for line in said) for other in others)

        self.assertTrue(image.hear(have_gone_on, qemu.PATIENCE), (others, image.lines()[before:]))
        done = image.end()
        self.assertNotIn(f'{name} probe', done.out)
        self.check_said(done.out, others, 1)

    def test_four_go_on_beside_an_a05_that_does_not_answer(self):
        self.none_answers('bumper', 'NO_RESPONSE')

    def test_four_go_on_beside_an_a16_that_does_not_send(self):
        self.none_answers('silo', 'STALE')

    def response_to_the_end(self, image, device, request, response):
        """The last request may be cut off by the end of the image."""
        got = b''
        while True:
            ready = select.select([device.master, image.pidfd], [], [], qemu.PATIENCE)[0]
            self.assertNotEqual(ready, [], f'the image does not end, and asks nothing: {got.hex(" ")}')
            if device.master not in ready:
                return
            got += os.read(device.master, len(request) - len(got))
            self.assertTrue(request.startswith(got), got.hex(' '))
            if got == request:
                device.write(response)
                got = b''

    def test_four_go_on_beside_a_line_with_noise_damage_strangers_and_late_responses(self):
        ports = self.far_ends()
        tank = self.device()
        ports['tank'] = tank.port
        image = self.five_lines(ports, 6)
        request = e2e.adu(1, 3, 1, 1, 0, 1)  # the real-time value, 0x0101
        right = e2e.registers(1, 754)

        def asked():
            self.assertEqual(tank.read(8, qemu.PATIENCE), request)

        def failed(error):
            image.expect(rf'^tank error {error}$', seconds=qemu.PATIENCE)

        def answered():
            asked()
            tank.write(right)

        answered()
        asked()
        tank.write(b'\x55\xAA\x00\xFF\x02\xF2' * 20)
        failed('NO_RESPONSE')
        answered()
        asked()
        tank.write(right[:-1] + bytes((right[-1] ^ 1,)))
        failed('CHECKSUM')
        answered()
        asked()
        tank.write(e2e.registers(2, 999))
        failed('NO_RESPONSE')
        answered()
        asked()
        failed('NO_RESPONSE')
        tank.write(right)  # late
        self.response_to_the_end(image, tank, request, right)
        done = self.end_well(image)
        self.check_said(done.out, SAID, 6)
        self.assertEqual(tank.baud(), e2e.termios.B9600)


if __name__ == '__main__':
    qemu.main()
