#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read --reconnect: a port that is lost is waited for and read on. The port is a link to a pseudo
terminal, and comes back as another one. It needs real time: CTest runs one such file at a time."""
import fcntl
import os
import shutil
import signal
import time

import e2e

LOST = 'the device was unplugged or its far end closed'


class PlugCase(e2e.Case):
    def setUp(self):
        super().setUp()
        self.port = self.path('port')

    def plug_in(self):
        """A new device behind the link."""
        device = self.device()
        os.symlink(device.port, self.path('new'))
        os.replace(self.path('new'), self.port)
        return device

    def begin(self, options='', sensor='a16 --mode modbus', timeout=2000):
        return self.fathom(f'read {sensor} --port {self.port} --timeout {timeout} --format csv --reconnect '
                           f'{options}')

    def answer(self, device, *values):
        for value in values:
            device.asked(e2e.ASK_A16, e2e.registers(1, value))

    def pull(self, device, reader, words=LOST):
        os.unlink(self.port)
        device.hang_up()
        reader.expect(words, 'err')

    def lose(self, options='', *values):
        """A reader whose port is lost in an attempt, after these readings."""
        device = self.plug_in()
        reader = self.begin(options)
        self.answer(device, *values)
        device.asked(e2e.ASK_A16)
        self.pull(device, reader)
        return reader

    def rows(self, done):
        return [(int(row['sequence']), int(row['distance_mm'])) for row in done.rows]


class Plug(PlugCase):
    def test_a_sensor_that_is_asked_is_read_on_and_the_count_goes_on(self):
        reader = self.lose('--count 5 --stats', 1111, 1112)
        self.answer(self.plug_in(), 1113, 1114)
        done = self.ends(reader, 1, f'fathom: {self.port}: it is back; reading goes on\n',
                         'attempts 5, failed 1, readings 4\n')
        # one header, sequence numbers that do not begin again, one failed attempt
        self.assertEqual(self.rows(done), [(1, 1111), (2, 1112), (3, 1113), (4, 1114)])
        self.assertRegex(done.err, f'attempt 3: .*{LOST}.*. Waiting until it is back\n')
        self.assertEqual((done.err.count(LOST), done.err.count('it is back; reading goes on')), (1, 1))

    def test_a_sensor_that_sends_is_read_on_without_a_word_about_the_time_that_it_was_away(self):
        device = self.plug_in()
        reader = self.begin('--count 4 --stats', sensor='a16', timeout=1000)  # a frame comes every 60 ms
        self.send(device, reader, 1)
        self.pull(device, reader)
        time.sleep(1.2)  # longer than the time-out: it would be stale
        self.send(self.plug_in(), reader, 3)
        done = self.ends(reader, 1, 'attempts 4, failed 1, readings 3\n')
        self.assertEqual(set(done.mm), {'1953'})
        self.assertNotIn('no byte was received', done.err)

    def send(self, device, reader, readings):
        """Frames, until so many readings are there or the reader has ended."""
        while sum(',target,' in line for line in reader.lines()) < readings and not reader.has_ended(0.06):
            device.write(e2e.frame(1953))

    def test_what_came_before_the_loss_is_not_joined_to_what_comes_after_it(self):
        device = self.plug_in()
        reader = self.begin(timeout=400)
        response = e2e.registers(1, 2222)
        device.asked(e2e.ASK_A16, response[:4])
        time.sleep(0.02)
        self.pull(device, reader)
        self.plug_in().asked(e2e.ASK_A16, response[4:])
        reader.expect(r'attempt \d: ', 'err')
        self.assertEqual(self.ends(reader.end(signal.SIGINT), 1).rows, [])

    def test_it_is_lost_again_and_again(self):
        reader = self.lose('--stats', 1000)
        for mm in (1001, 1002):
            device = self.plug_in()
            self.answer(device, mm)
            device.asked(e2e.ASK_A16)
            self.pull(device, reader)
        done = self.ends(reader.end(signal.SIGINT), 1, 'attempts 6, failed 3, readings 3\n', 'reconnects 2\n',
                         'failures: port 3\n')
        self.assertEqual(self.rows(done), [(1, 1000), (2, 1001), (3, 1002)])

    def test_it_ends_at_once_and_cleanly_while_it_waits(self):
        reader = self.lose('--stats', 1111)
        reader.send(signal.SIGSTOP)
        device = self.plug_in()  # if it waited on, it would find this
        reader.send(signal.SIGINT)
        reader.send(signal.SIGCONT)
        done = self.ends(reader, 1, 'attempts 2, failed 1, readings 1\n')
        self.assertNotIn('it is back; reading goes on', done.err)
        self.assertEqual(device.rest(), b'')
        self.assertEqual(self.rows(done), [(1, 1111)])

    def test_what_is_no_port_is_not_waited_for(self):
        with open(self.port, 'w', encoding='ascii'):
            pass
        self.assertNotIn('aiting', self.ends(self.begin(), 1, 'not a serial port', out='').err)

    def test_waiting_takes_next_to_no_cpu_and_few_words(self):
        reader = self.lose('', 1111)
        time.sleep(2)
        done = reader.end()
        self.needs_little(done)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)  # the loss

    def test_a_port_that_opens_and_is_lost_at_once_is_not_tried_without_a_pause(self):
        """The link shows a port that hangs up as soon as it was opened: a failed attempt each time, with the least pause
        of 0.5 s before the next."""
        device = self.plug_in()
        reader = self.begin()
        began = None
        for _ in range(4):
            device.read(8)
            began = began or time.monotonic()
            self.pull(device, reader)
            device = self.plug_in()
        self.assertGreater(time.monotonic() - began, 3 * 0.5)
        done = reader.end()
        self.needs_little(done)
        self.assertEqual(done.err.count(LOST), 4)

    def test_a_port_in_use_when_it_comes_back_is_waited_for_and_told(self):
        reader = self.lose('--count 3', 1111)
        device = self.device()
        fcntl.flock(device.slave, fcntl.LOCK_EX)
        os.symlink(device.port, self.port)
        reader.expect('still waiting: .*in use by another program', 'err')
        time.sleep(1.2)  # two more tries, and not a word
        fcntl.flock(device.slave, fcntl.LOCK_UN)
        self.answer(device, 1113)
        done = reader.finish()
        self.assertEqual(self.rows(done), [(1, 1111), (2, 1113)])
        self.assertEqual(done.err.count('still waiting'), 1)


class Adapters(PlugCase):
    """USB adapters that share a serial number or have none: the sensor at the port tank is in socket 1-1.2."""
    SAME_SOCKET = r'\. Plug this adapter into the same USB socket \(1-1\.2\)$'

    def setUp(self):
        super().setUp()
        for folder in ('sys/class/tty', 'sys/devices', 'dev'):
            os.makedirs(self.path(folder))
        self.environment = self.preload('usb_shim.c', USB_ROOT=self.path(''))

    def plug(self, tty, socket, serial):
        """An adapter in a socket, with a device behind it. Its device file appears last, as the kernel does it."""
        device = self.device()
        usb = self.path(f'sys/devices/usb1/1-1/{socket}')
        port = f'{usb}/{socket}:1.0/{tty}'
        os.makedirs(port)
        facts = {f'{usb}/idVendor': '10c4', f'{usb}/idProduct': 'ea60', f'{usb}/serial': serial,
                 f'{usb}/{socket}:1.0/bInterfaceNumber': '00', f'{port}/port_number': '0'}
        for name, text in facts.items():
            if text:
                with open(name, 'w', encoding='ascii') as file:
                    file.write(text + '\n')
        os.makedirs(self.path(f'sys/class/tty/{tty}'))
        os.symlink(port, self.path(f'sys/class/tty/{tty}/device'))
        os.symlink(device.port, self.path(f'dev/{tty}'))
        return device

    def unplug(self, tty, socket, device):
        shutil.rmtree(self.path(f'sys/devices/usb1/1-1/{socket}'))
        shutil.rmtree(self.path(f'sys/class/tty/{tty}'))
        os.unlink(self.path(f'dev/{tty}'))
        device.hang_up()

    def begin_tank(self, serial):
        tank = self.plug('ttyUSB0', '1-1.2', serial)
        reader = self.fathom('read tank=a16:modbus --port /dev/ttyUSB0 --timeout 2000 --format csv --reconnect',
                             env=self.environment)
        return tank, reader

    def lose_tank(self, tank, reader):
        tank.asked(e2e.ASK_A16)
        self.unplug('ttyUSB0', '1-1.2', tank)
        reader.expect(LOST, 'err')

    def ends_with_tank(self, reader, tty, serial, *others):
        """Two tries leave the others alone; then the adapter is plugged in again, under another name."""
        for other in others:
            self.assertTrue(other.is_silent(1.8))
        self.answer(self.plug(tty, '1-1.2', serial), 1500)
        reader.expect(f'fathom: /dev/{tty}: it is back; reading goes on', 'err')
        reader.expect(',1500,')
        self.assertEqual({mm for _, mm in self.rows(reader.end())}, {1500})
        for other in others:
            self.assertTrue(other.is_silent())

    @e2e.each(a_twin_with_the_same_number_is_not_read=(
        '0002', 'another adapter has, or may have had, the same serial number'),
              a_twin_without_a_number_is_not_read=('', 'this adapter has no serial number'))
    def begins(self, serial, reason):
        twin = self.plug('ttyUSB1', '1-1.3', serial)
        tank, reader = self.begin_tank(serial)
        self.answer(tank, 1500)
        self.lose_tank(tank, reader)
        reader.expect(f'fathom: /dev/ttyUSB0: {reason}{self.SAME_SOCKET}', 'err')
        self.ends_with_tank(reader, 'ttyUSB0', serial, twin)

    def test_an_adapter_with_its_own_number_is_read_in_another_socket(self):
        tank, reader = self.begin_tank('0002')
        self.answer(tank, 1500)
        self.lose_tank(tank, reader)
        self.answer(self.plug('ttyUSB4', '1-1.4', '0002'), 1501)
        reader.expect('fathom: /dev/ttyUSB4: it is back; reading goes on', 'err')
        reader.expect(',1501,')
        self.assertNotIn('USB socket', reader.end().err)


if __name__ == '__main__':
    e2e.main()
