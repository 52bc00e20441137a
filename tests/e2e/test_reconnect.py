#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read --reconnect: a port that is lost is waited for and read on. The port is a link to a pseudo terminal, and
comes back as another one."""
import fcntl
import os
import select
import signal
import time

import e2e

REQUEST = e2e.adu(1, 3, 1, 0, 0, 1)
LITTLE = 0.3  # seconds of CPU
LOST = 'the device was unplugged or its far end closed'


class Plug(e2e.Case):
    def plug_in(self):
        """A new device behind the link."""
        device = self.device()
        os.symlink(device.path, self.path('new'))
        os.replace(self.path('new'), self.path('port'))
        return device

    def pull(self, device):
        os.unlink(self.path('port'))
        device.hang_up()

    def begin(self, *arguments, sensor=('a16', '--mode', 'modbus')):
        return self.fathom('read', *sensor, '--port', self.path('port'), '--timeout', 400, '--format', 'csv',
                           '--reconnect', *arguments)

    def answer(self, device, *values, request=REQUEST):
        for value in values:
            self.assertEqual(device.read(len(request)), request)
            device.write(e2e.registers(1, value))

    def rows(self, done):
        """sequence and distance"""
        return [(int(row.split(',')[4]), int(row.split(',')[9])) for row in done.out.splitlines()[1:]]

    def test_a_sensor_that_is_asked_is_read_on_and_the_count_goes_on(self):
        device = self.plug_in()
        reader = self.begin('--count', 5)
        self.answer(device, 1111, 1112)
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        reader.expect(f'attempt 3: .*{LOST}.*; waiting until it is back$', 'err')
        device = self.plug_in()
        self.answer(device, 1113, 1114)
        done = reader.finish()
        # one header, sequence numbers that do not begin again, one failed attempt
        self.assertEqual(self.rows(done), [(1, 1111), (2, 1112), (3, 1113), (4, 1114)])
        self.assertEqual(done.code, 1)
        self.assertIn('attempts 5, failed 1, readings 4\n', done.err)
        self.assertEqual(done.err.count(LOST), 1)
        self.assertEqual(done.err.count(f'fathom: {self.path("port")}: it is back; reading goes on\n'), 1)

    def test_a_sensor_that_sends_is_read_on_without_a_word_about_the_time_that_it_was_away(self):
        device = self.plug_in()
        reader = self.begin('--count', 4, sensor=('a16',))
        self.send(device, reader, 2)
        self.pull(device)
        reader.expect(LOST, 'err')
        time.sleep(0.6)  # longer than the time-out: it would be stale
        device = self.plug_in()
        self.send(device, reader, 4)
        done = reader.finish()
        self.assertEqual({mm for _, mm in self.rows(done)}, {1953})
        self.assertEqual(done.code, 1)
        self.assertIn('attempts 4, failed 1, readings 3\n', done.err)
        self.assertNotIn('nothing was heard', done.err)

    def send(self, device, reader, lines):
        """Frames, until so many lines are there or the reader has ended."""
        deadline = time.monotonic() + e2e.PATIENCE
        while len(reader.seen['out']) < lines and time.monotonic() < deadline:
            device.write(e2e.frame(1953))
            if select.select([reader.pidfd], [], [], 0.06)[0]:
                return

    def test_what_came_before_the_loss_is_not_joined_to_what_comes_after_it(self):
        device = self.plug_in()
        reader = self.begin('--count', 2)
        self.assertEqual(device.read(8), REQUEST)
        answer = e2e.registers(1, 2222)
        device.write(answer[:4])
        time.sleep(0.02)
        self.pull(device)
        reader.expect(LOST, 'err')
        device = self.plug_in()
        self.assertEqual(device.read(8), REQUEST)
        device.write(answer[4:])
        done = reader.finish()
        self.assertEqual((self.rows(done), done.code), ([], 1))

    def test_it_is_lost_again_and_again(self):
        reader = None
        for number in range(3):
            device = self.plug_in()
            reader = reader or self.begin('--stats')
            self.answer(device, 1000 + number)
            self.assertEqual(device.read(8), REQUEST)
            self.pull(device)
            reader.expect(LOST, 'err')
        done = reader.end(signal.SIGINT)
        self.assertEqual(self.rows(done), [(1, 1000), (2, 1001), (3, 1002)])
        self.assertEqual(done.code, 1)
        self.assertIn('attempts 6, failed 3, readings 3\n', done.err)
        self.assertIn('reconnects 2\n', done.err)
        self.assertIn('port 3,', done.err)

    def test_it_ends_at_once_and_cleanly_while_it_waits(self):
        device = self.plug_in()
        reader = self.begin()
        self.answer(device, 1111)
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        reader.expect(LOST, 'err')
        began = time.monotonic()
        done = reader.end(signal.SIGINT)
        self.assertLess(time.monotonic() - began, 0.4)
        self.assertEqual((done.code, self.rows(done)), (1, [(1, 1111)]))
        self.assertIn('attempts 2, failed 1, readings 1\n', done.err)

    def test_a_loss_in_the_last_attempt_is_not_waited_out(self):
        device = self.plug_in()
        reader = self.begin('--count', 1)
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        done = reader.finish(5)
        self.assertEqual(done.code, 1)
        self.assertNotIn('waiting', done.err)

    def test_a_port_that_is_not_there_yet_is_waited_for(self):
        reader = self.begin('--count', 1)
        reader.expect('port: no such device.*; waiting until it is there$', 'err')
        device = self.plug_in()
        self.answer(device, 1111)
        done = reader.finish()
        self.assertEqual((done.code, self.rows(done)), (0, [(1, 1111)]))
        self.assertIn(': it is there; reading begins\n', done.err)

    def test_a_port_that_never_comes_can_be_given_up(self):
        reader = self.begin()
        reader.expect('waiting until it is there$', 'err')
        done = reader.end(signal.SIGTERM)
        self.assertEqual((done.code, done.out), (0, ''))
        self.assertIn('attempts 0, failed 0, readings 0\n', done.err)

    def test_what_is_no_port_is_not_waited_for(self):
        with open(self.path('port'), 'w', encoding='ascii'):
            pass
        done = self.begin().finish(5)
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertIn('not a serial port', done.err)
        self.assertNotIn('waiting', done.err)

    def test_waiting_takes_next_to_no_cpu_and_few_words(self):
        device = self.plug_in()
        reader = self.begin()
        self.answer(device, 1111)
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        reader.expect(LOST, 'err')
        time.sleep(2)
        done = reader.end()
        self.assertLess(done.cpu, LITTLE)
        self.assertEqual(len(done.err.splitlines()), 3, done.err)  # the loss, and two of counters

    def test_a_port_that_opens_and_is_lost_at_once_is_not_tried_without_a_pause(self):
        """The link shows a port that hangs up as soon as it was opened: a failed attempt each time, not thousands."""
        device = self.plug_in()
        reader = self.begin()
        losses = 0
        ends = time.monotonic() + 2.5
        while time.monotonic() < ends:
            if select.select([device.master], [], [], 0.05)[0]:
                device.read(8)
                device.hang_up()
                losses += 1
                reader.expect(LOST, 'err')  # the last one too has to be seen before the end
                device = self.plug_in()
        done = reader.end()
        self.assertTrue(2 <= losses <= 6, losses)
        self.assertLess(done.cpu, LITTLE)
        self.assertEqual(done.err.count(LOST), losses)

    def test_without_it_a_lost_port_ends_the_run(self):
        device = self.plug_in()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', self.path('port'))
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        done = reader.finish(5)
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertIn('connect it again and start again (with --reconnect it is waited for)', done.err)

    def test_a_port_in_use_when_it_comes_back_is_waited_for_and_told(self):
        device = self.plug_in()
        reader = self.begin('--count', 3)
        self.answer(device, 1111)
        self.assertEqual(device.read(8), REQUEST)
        self.pull(device)
        reader.expect(LOST, 'err')
        device = self.device()
        fcntl.flock(device.slave, fcntl.LOCK_EX)
        os.symlink(device.path, self.path('port'))
        reader.expect('still waiting: .*in use by another program', 'err')
        time.sleep(1.2)  # two more tries, and not a word
        fcntl.flock(device.slave, fcntl.LOCK_UN)
        self.answer(device, 1113)
        done = reader.finish()
        self.assertEqual(self.rows(done), [(1, 1111), (2, 1113)])
        self.assertEqual(done.err.count('still waiting'), 1)


if __name__ == '__main__':
    e2e.main()
