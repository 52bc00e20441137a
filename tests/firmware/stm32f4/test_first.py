#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/stm32f4/first.c on QEMU's netduinoplus2, and those of examples/first/MODE.c whose sensor has a rate that QEMU's
USARTs have, 115200 baud. USART1 has the text of printf(), USART2 the sensor."""
import re

import qemu


class First(qemu.Case):
    def boot_with_text(self, image, sensor):
        """Starts an image. Returns a function that reads the next line of its text."""
        text = self.device()
        self.boot(image, text.port, sensor.port)
        return lambda: self.next_line(text)

    def next_line(self, text):
        line = b''
        while not line.endswith(b'\n'):
            line += text.read(1, qemu.PATIENCE)
        return line.decode().rstrip('\n')

    def reads(self, image, sensor, line):
        """Five readings, between errors that a slow machine causes; each of those has a name and an advice."""
        read = self.boot_with_text(image, self.sim(sensor, '--baud 115200'))
        readings = 0
        for _ in range(100):
            said = read()
            error = re.fullmatch(r'no reading \((\w+)\)\. [A-Z].*\.', said)
            if error:
                self.assertIn(error[1], qemu.LATE)
                continue
            self.assertEqual(said, line)
            readings += 1
            if readings == 5:
                return
        self.fail(f'{readings} readings among 100 lines')

    def test_the_complete_program_prints_readings(self):
        self.reads('first_qemu', 'hps167s --distance 2083', '2083 mm')

    def test_nothing_in_range_is_printed(self):
        self.reads('first_qemu', 'hps167s --distance no-target', 'nothing in range')

    def test_silence_is_an_error_with_advice(self):
        read = self.boot_with_text('first_qemu', self.device())
        for _ in range(2):
            self.assertRegex(read(), r'^no reading \(NO_RESPONSE\)\. [A-Z].*\.$')

    def test_the_program_of_the_mode_prints_readings(self):
        self.reads('first_hps167s_qemu', 'hps167s --distance 2083', 'probe 1: 2083 mm')

    def test_a_sensor_that_sends_by_itself_is_printed(self):
        self.reads('first_hps167s_auto_qemu', 'hps167s::auto --distance 2083', 'probe 1: 2083 mm')


if __name__ == '__main__':
    qemu.main()
