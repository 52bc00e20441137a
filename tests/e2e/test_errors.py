#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What fathom read says and returns when the port, the line or the output fails, and when it is to end."""
import fcntl
import os
import random
import re
import select
import signal
import time

import e2e

LITTLE = 0.3  # seconds of CPU; a program that spins takes ten times as much in these tests


class Ports(e2e.Case):
    def check(self, port, words):
        done = self.run_fathom('read', 'a16', '--port', port)
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        self.assertIn(port, done.err)
        self.assertIn(words, done.err)

    def test_a_port_that_is_not_there(self):
        self.check(self.path('nowhere'), 'no such device; is it plugged in?')

    def test_a_file_is_no_port(self):
        with open(self.path('file'), 'w', encoding='ascii'):
            pass
        self.check(self.path('file'), 'not a serial port')

    def test_a_folder_is_no_port(self):
        self.check(self.folder, 'not a serial port')

    def test_the_null_device_is_no_port(self):
        self.check('/dev/null', 'not a serial port')

    def test_a_port_that_another_fathom_reads_is_in_use(self):
        sim = self.sim('a16', '--distance', '754')
        first = self.fathom('read', 'a16', '--port', sim.port)
        first.expect('754 mm')
        self.check(sim.port, 'in use by another program')
        first.expect('754 mm')
        self.assertEqual(first.end().code, 0)

    def test_a_port_that_another_program_has_locked_is_in_use(self):
        device = self.device()
        fcntl.flock(device.slave, fcntl.LOCK_EX)
        self.check(device.path, 'in use by another program')


class Silence(e2e.Case):
    """Attempts that fail: a line each, the next follows, exit status 1."""

    def fails(self, words, *arguments, attempts=1, **options):
        done = self.run_fathom('read', *arguments, '--count', attempts, **options)
        self.assertEqual((done.code, done.out), (1, ''), done.err)
        lines = [line for line in done.err.splitlines() if line.startswith('fathom: attempt ')]
        self.assertEqual(len(lines), attempts, done.err)
        for number, line in enumerate(lines, 1):
            self.assertTrue(line.startswith(f'fathom: attempt {number}: '), line)
            self.assertIn(words, line)
        self.assertIn(f'fathom: attempts {attempts}, failed {attempts}, readings 0\n', done.err)
        return done

    def test_a_stream_of_nothing_is_stale(self):
        done = self.fails('nothing was heard at all; check the supply', 'a16', '--port', self.device().path,
                          '--timeout', '200', attempts=3)
        self.assertIn('line: stale 3\n', done.err)
        self.assertTrue(0.6 <= done.elapsed < 5, done.elapsed)

    def test_the_same_for_an_a05(self):
        done = self.fails('nothing was heard at all', 'a05', '--port', self.device().path, '--timeout', '200')
        self.assertTrue(0.2 <= done.elapsed < 2, done.elapsed)

    def test_without_a_time_out_a_stream_is_stale_after_two_seconds(self):
        done = self.fails('nothing was heard at all', 'a05', '--port', self.device().path)
        self.assertTrue(2 <= done.elapsed < 4, done.elapsed)

    def test_nobody_at_this_address(self):
        sim = self.sim('hps167s:3', '--distance', '500')
        done = self.fails('no answer from address 4: nothing was heard at all', 'hps167s', '--address', '4',
                          '--port', sim.port, '--timeout', '100', attempts=2)
        self.assertIn('--address', done.err)

    def test_a_dead_line_in_every_mode_that_asks(self):
        for sensor in ('a16', 'a05', 'hps167s'):
            with self.subTest(sensor):
                done = self.fails('no answer from address 1: nothing was heard at all', sensor, '--mode', 'modbus',
                                  '--port', self.device().path, '--timeout', '100', attempts=5)
                self.assertTrue(0.5 <= done.elapsed < 2.5, done.elapsed)  # the shortest default is 0.5 s

    def test_retries_are_requests_of_one_attempt(self):
        device = self.device()
        done = self.fails('no answer', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', '50',
                          '--retries', '2')
        self.assertEqual(device.read(24), e2e.adu(1, 3, 1, 0, 0, 1) * 3)
        self.assertTrue(device.is_silent(0))
        self.assertIn('requests without an answer 3', done.err)

    def test_the_wrong_baud_rate_of_a_sensor_that_sends(self):
        sim = self.sim('a16', '--distance', '754')
        reader = self.fathom('read', 'a16', '--port', sim.port, '--baud', '19200', '--timeout', '500')
        reader.expect(r'bytes were heard, but no frame of a16; check --baud and --parity \(now 19200 8N1\)', 'err')
        done = reader.end()
        self.assertEqual(done.code, 1)
        # The simulator learns of the rate when it next looks: what is under way then may come through.
        self.assertLessEqual(done.out.count('mm'), 1)

    def test_the_wrong_baud_rate_of_a_sensor_that_is_asked(self):
        sim = self.sim('hps167s', '--distance', '754')
        self.fails('(now 9600 8E1)', 'hps167s', '--port', sim.port, '--baud', '9600', '--timeout', '200')

    def test_another_sensor_than_was_said(self):
        sim = self.sim('a05', '--distance', '1000,2000,1953,3562')
        self.fails('frames of an a05 that sends by itself were heard; try: fathom read a05', 'a16', '--port',
                   sim.port, '--timeout', '700')

    def test_a_distance_that_the_sensor_cannot_mean(self):
        sim = self.sim('a16::modbus', '--distance', '40000')
        self.fails('a value that cannot be a distance: 40000;', 'a16', '--mode', 'modbus', '--port', sim.port)

    def test_a_frame_with_a_distance_that_the_sensor_cannot_mean(self):
        sim = self.sim('a05', '--distance', '1000,2000,40000,3000')
        self.fails('a value that cannot be a distance: 1000 2000 40000 3000;', 'a05', '--port', sim.port)

    def test_an_hps167s_that_says_what_it_cannot_mean(self):
        sim = self.sim('hps167s', '--distance', '50000')
        self.fails('a value that cannot be a distance: 50000 ', 'hps167s', '--port', sim.port)

    def test_one_bad_probe_of_four_fails_the_attempt_and_not_the_others(self):
        sim = self.sim('a05::modbus', '--distance', '1000,40000,1953,50000')
        done = self.run_fathom('read', 'a05', '--mode', 'modbus', '--port', sim.port, '--count', '1')
        self.assertEqual(done.code, 1)
        self.assertEqual(re.findall(r'probe (\d) +(\d+) mm', done.out), [('1', '1000'), ('3', '1953')])
        self.assertEqual(re.findall(r'attempt 1: probe (\d): a value that cannot be a distance: (\d+);', done.err),
                         [('2', '40000'), ('4', '50000')])
        self.assertIn('attempts 1, failed 1, readings 2\n', done.err)

    def test_the_next_attempt_follows_a_failed_one(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', '100',
                             '--count', '2')
        device.read(8)
        reader.expect('attempt 1: no answer', 'err')
        self.assertEqual(device.read(8), e2e.adu(1, 3, 1, 0, 0, 1))
        device.write(e2e.registers(1, 754))
        done = reader.finish()
        self.assertEqual((done.code, done.out.count('754 mm')), (1, 1))
        self.assertIn('attempts 2, failed 1, readings 1\n', done.err)


class Noise(e2e.Case):
    def begin(self, *arguments):
        """A reader whose port is open: csv tells, by its header."""
        device = self.device()
        reader = self.fathom('read', *arguments, '--port', device.path, '--format', 'csv')
        reader.expect('^sensor,')
        return device, reader

    def feed(self, device, reader, data, until, pause=0.04):
        """Sends the data again and again, with pauses, until the reader says something on stderr."""
        deadline = time.monotonic() + e2e.PATIENCE
        while time.monotonic() < deadline:
            device.write(data)
            select.select([reader.pidfd], [], [], pause)
            if any(re.search(until, line) for line in reader.seen['err']):
                return
        self.fail(f'{until!r} did not come: {reader.seen}')

    def test_a_flood_of_garbage_is_no_reading_and_can_be_ended(self):
        device, reader = self.begin('a16', '--timeout', '300')
        garbage = bytes(byte for byte in random.Random(1).randbytes(4000) if byte != 0xFF)
        self.feed(device, reader, garbage, 'bytes were heard, but no frame of a16', pause=0)
        os.set_blocking(device.master, False)
        reader.send(signal.SIGINT)
        while not select.select([reader.pidfd], [], [], 0)[0]:  # the flood goes on while it ends
            try:
                device.write(garbage)
            except BlockingIOError:
                pass
        done = reader.finish()
        self.assertEqual((done.code, done.out.count('\n')), (1, 1))

    def test_half_frames_are_no_reading(self):
        for data in (e2e.frame(1953)[:3], e2e.frame(1953)[1:]):
            with self.subTest(data.hex()):
                device, reader = self.begin('a16', '--timeout', '300')
                self.feed(device, reader, data, 'bytes were heard, but no frame of a16')
                self.assertEqual(reader.end().out.count('\n'), 1)

    def test_a_wrong_sum_is_no_reading(self):
        device, reader = self.begin('a05', '--timeout', '300')
        data = bytearray(e2e.frame(1000, 2000, 1953, 3562))
        data[9] ^= 1
        self.feed(device, reader, data, 'bytes were heard, but no frame of a05')
        self.assertEqual(reader.end().out.count('\n'), 1)

    def test_frames_without_any_pause_whose_beginning_cannot_be_told(self):
        device, reader = self.begin('a16', '--timeout', '300')
        self.feed(device, reader, e2e.frame(511) * 50, 'look like frames of a16, but not where one begins', pause=0)
        self.assertEqual(reader.end().code, 1)

    def test_a_good_frame_after_garbage_is_read(self):
        device, reader = self.begin('a16', '--timeout', '300', '--count', '2')
        self.feed(device, reader, b'\x12\x34\x56', 'no frame of a16')
        deadline = time.monotonic() + e2e.PATIENCE
        while not select.select([reader.pidfd], [], [], 0.06)[0] and time.monotonic() < deadline:
            device.write(e2e.frame(1953))
        done = reader.finish()
        self.assertEqual((done.code, done.out.count(',target,false,1953,1953\n')), (1, 1), done)

    def asked(self, answer, words, *arguments):
        """One request, answered so."""
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--count', '1', '--timeout',
                             '300', *arguments)
        self.assertEqual(device.read(8), e2e.adu(1, 3, 1, 0, 0, 1))
        device.write(answer)
        done = reader.finish()
        self.assertEqual((done.code, done.out), (1, ''), done.err)
        self.assertIn(f'attempt 1: {words}', done.err)
        self.assertEqual(done.err.count('attempt 1: '), 1)

    def test_bytes_that_are_no_frame(self):
        self.asked(b'\x55\xAA\x55', 'no answer from address 1: bytes were heard, but no Modbus frame')

    def test_the_cause_is_that_of_this_attempt_and_not_of_one_before(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--count', '2', '--timeout', '300')
        device.read(8)
        device.write(b'\x55\xAA\x55')
        device.read(8)
        done = reader.finish()
        self.assertIn('attempt 1: no answer from address 1: bytes were heard, but no Modbus frame', done.err)
        self.assertIn('attempt 2: no answer from address 1: nothing was heard at all', done.err)

    def test_a_damaged_answer(self):
        answer = bytearray(e2e.registers(1, 754))
        answer[4] ^= 0x10
        self.asked(answer, 'the answer of address 1 was damaged')

    def test_an_answer_that_breaks_off(self):
        self.asked(e2e.registers(1, 754)[:5], 'the answer of address 1 was damaged')

    def test_an_answer_of_another_unit(self):
        self.asked(e2e.registers(2, 754), 'no answer from address 1: the line works, but it was address 2 that was heard; try --address 2')

    def test_an_answer_of_another_length(self):
        self.asked(e2e.registers(1, 754, 755), 'address 1 answered something else than was asked')

    def test_an_exception_has_its_number_and_name(self):
        self.asked(e2e.adu(1, 0x83, 2), 'address 1 refused: exception 02 (illegal data address)')

    def test_an_exception_without_a_name(self):
        self.asked(e2e.adu(1, 0x83, 0x63), 'address 1 refused: exception 99 (unknown)')


class HangUp(e2e.Case):
    def killed(self, *arguments, sensor='a16::auto'):
        sim = self.sim(sensor, '--distance', '754')
        reader = self.fathom('read', sensor.split(':')[0], '--mode', sensor.split(':')[2], '--port', sim.port, *arguments)
        reader.expect('754 mm')
        sim.end(signal.SIGKILL)
        done = reader.finish(5)
        self.assertEqual(done.code, 1)
        self.assertRegex(done.err, rf'(?m)^fathom: attempt \d+: {sim.port}: the device was unplugged or its far end '
                                   r'closed \(.*\); connect it again')
        self.assertRegex(done.err, r'attempts \d+, failed 1, ')
        self.assertLess(done.cpu, LITTLE)

    def test_a_sensor_that_sends(self):
        self.killed()

    def test_a_sensor_that_is_asked(self):
        self.killed(sensor='hps167s::modbus')

    def test_in_a_long_pause_between_two_requests(self):
        self.killed('--interval', '600000', sensor='hps167s::modbus')

    def test_in_a_long_pause_between_two_frames(self):
        self.killed('--interval', '600000')

    def test_a_port_that_hangs_up_before_the_first_answer(self):
        device = self.device()
        reader = self.fathom('read', 'a05', '--mode', 'modbus', '--port', device.path)
        device.read(8)
        device.hang_up()
        done = reader.finish(5)
        self.assertEqual((done.code, done.out), (1, ''))
        self.assertIn('the device was unplugged', done.err)


class Signals(e2e.Case):
    def ended(self, number, code, *arguments, expect, stream):
        sim = self.sim('hps167s:2', '--distance', '754')
        reader = self.fathom('read', 'hps167s', '--port', sim.port, *arguments)
        reader.expect(expect, stream)
        began = time.monotonic()
        done = reader.end(number)
        self.assertLess(time.monotonic() - began, 2)
        self.assertEqual(done.code, code)
        self.assertRegex(done.err, r'(?m)^fathom: attempts [1-9]\d*, failed \d+, readings \d+$')

    def test_interrupt_after_good_readings_is_success(self):
        self.ended(signal.SIGINT, 0, '--address', '2', expect='754 mm', stream='out')

    def test_terminate_too(self):
        self.ended(signal.SIGTERM, 0, '--address', '2', expect='754 mm', stream='out')

    def test_hang_up_too(self):
        self.ended(signal.SIGHUP, 0, '--address', '2', expect='754 mm', stream='out')

    def test_in_a_long_pause(self):
        self.ended(signal.SIGINT, 0, '--address', '2', '--interval', '600000', expect='754 mm', stream='out')

    def test_after_a_failure_it_stays_a_failure(self):
        self.ended(signal.SIGINT, 1, '--address', '3', '--timeout', '100', expect='no answer', stream='err')

    def test_in_the_middle_of_an_attempt(self):
        device = self.device()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', '600000')
        device.read(8)
        done = reader.end(signal.SIGINT)
        self.assertEqual((done.code, done.out), (0, ''))
        self.assertEqual(done.err, 'fathom: attempts 0, failed 0, readings 0\n')

    def test_just_before_it_goes_to_sleep(self):
        done = self.run_fathom('read', 'a16', '--port', self.device().path, '--timeout', '600000',
                               env=self.preload('signal_shim.c'))
        self.assertEqual((done.code, done.out), (0, ''))

    def test_while_nobody_reads_the_output(self):
        sim = self.sim('hps167s', '--distance', '754')
        out, pipe = os.pipe()
        self.addCleanup(os.close, out)
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, 4096)
        os.write(pipe, b'x' * 4000)
        reader = self.fathom('read', 'hps167s', '--port', sim.port, '--format', 'json', stdout=pipe)
        os.close(pipe)
        # Blocked in write(2): the system says so.
        deadline = time.monotonic() + e2e.PATIENCE
        while 'pipe' not in self.waits_in(reader) and time.monotonic() < deadline:
            select.select([reader.pidfd], [], [], 0.01)
        self.assertEqual(reader.end(signal.SIGINT).code, 0)

    @staticmethod
    def waits_in(program):
        try:
            with open(f'/proc/{program.process.pid}/syscall', encoding='ascii') as file:
                return 'pipe' if file.read().startswith('1 0x1 ') else ''
        except OSError:  # not allowed here: the wait above ends by its deadline
            return ''


class Output(e2e.Case):
    def test_a_reader_that_has_seen_enough_ends_it_without_words(self):
        sim = self.sim('hps167s', '--distance', '754')
        out, pipe = os.pipe()
        reader = self.fathom('read', 'hps167s', '--port', sim.port, stdout=pipe)
        os.close(pipe)
        self.assertIn(b'754 mm', os.read(out, 4000))
        os.close(out)
        done = reader.finish()
        self.assertEqual((done.code, done.err), (1, ''))

    def test_a_reader_that_was_never_there_ends_it_too(self):
        out, pipe = os.pipe()
        os.close(out)
        reader = self.fathom('read', 'a16', '--port', self.device().path, '--format', 'csv', stdout=pipe)
        os.close(pipe)
        done = reader.finish()
        self.assertEqual((done.code, done.err), (1, ''))

    def test_also_when_there_is_nothing_to_write(self):
        device = self.device()
        out, pipe = os.pipe()
        reader = self.fathom('read', 'a16', '--mode', 'modbus', '--port', device.path, '--timeout', '600000',
                             stdout=pipe)
        os.close(pipe)
        device.read(8)
        os.close(out)
        done = reader.finish()
        self.assertEqual((done.code, done.err), (1, ''))
        self.assertLess(done.cpu, LITTLE)

    def test_a_full_disk_is_told(self):
        sim = self.sim('hps167s', '--distance', '754')
        with open('/dev/full', 'w', encoding='ascii') as full:
            done = self.run_fathom('read', 'hps167s', '--port', sim.port, stdout=full)
        self.assertEqual(done.code, 1)
        self.assertIn('the readings cannot be written: No space left on device', done.err)

    def test_no_output_at_all_never_becomes_the_port(self):
        device = self.device()
        reader = self.start('sh', '-c', f'exec "{e2e.FATHOM}" read a16 --port {device.path} >&-')
        done = reader.finish()
        self.assertEqual(done.code, 1)
        self.assertIn('the standard output is closed', done.err)
        self.assertTrue(device.is_silent(0))

    def test_closed_input_and_error_output_do_not_matter(self):
        sim = self.sim('hps167s', '--distance', '754')
        done = self.start('sh', '-c', f'exec "{e2e.FATHOM}" read hps167s --count 2 --port {sim.port} <&- 2>&-').finish()
        self.assertEqual((done.code, done.out.count('754 mm')), (0, 2))


class Idle(e2e.Case):
    def test_waiting_for_a_dead_sensor_takes_next_to_no_cpu(self):
        for arguments in (['a16'], ['a05', '--mode', 'modbus']):
            with self.subTest(arguments):
                done = self.run_fathom('read', *arguments, '--port', self.device().path, '--timeout', '3000',
                                       '--count', '1')
                self.assertEqual(done.code, 1)
                self.assertLess(done.cpu, LITTLE)

    def test_a_pause_between_readings_takes_next_to_no_cpu(self):
        sim = self.sim('hps167s', '--distance', '754')
        done = self.run_fathom('read', 'hps167s', '--port', sim.port, '--interval', '1500', '--count', '3')
        self.assertEqual(done.code, 0)
        self.assertLess(done.cpu, LITTLE)
        self.assertLess(sim.end().cpu, LITTLE)


if __name__ == '__main__':
    e2e.main()
