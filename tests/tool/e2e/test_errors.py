#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What fathom read says and returns when the port, the line or the output fails, and when it is to end."""
import fcntl
import os
import random
import re
import signal
import time

import e2e

FRAME = e2e.frame(1953)


class Ports(e2e.Case):
    @e2e.each(
        a_port_that_is_not_there=('nowhere', 'no such device; is it plugged in? /dev/serial/by-id lists what is\n'),
        a_file_is_no_port=('file', 'not a serial port'),
        a_folder_is_no_port=('', 'not a serial port'),
        the_null_device_is_no_port=('/dev/null', 'not a serial port'))
    def refused(self, port, words):
        with open(self.path('file'), 'w', encoding='ascii'):
            pass
        self.refuses(self.path(port), words)

    def refuses(self, port, words):
        done = self.ends(f'read a16 --port {port}', 1, str(port), words, out='')
        self.assertEqual(len(done.err.splitlines()), 1, done.err)

    def test_a_port_that_another_fathom_reads_is_in_use(self):
        sim = self.sim('a16 --distance 754')
        first = self.fathom(f'read a16 --port {sim}')
        first.expect('754 mm')
        self.refuses(sim, f'in use by another program: fathom (process {first.process.pid}). Stop it, then try again')
        first.expect('754 mm')
        self.assertEqual(first.end().code, 0)

    def test_a_port_that_another_program_has_locked_is_in_use(self):
        device = self.device()
        fcntl.flock(device.slave, fcntl.LOCK_EX)
        self.refuses(device, 'in use by another program')


class Silence(e2e.Case):
    def test_a_stream_of_nothing_is_stale_after_two_seconds_without_a_time_out(self):
        done = self.ends(f'read a05 --port {self.device()} --count 1 --stats', 1, 'no byte was received. Check the power',
                         'fathom: stream: stale 1\n', out='')
        self.assertGreaterEqual(done.elapsed, 2)

    @e2e.each(
        of_a_sensor_that_is_asked=('hps167s --distance 754', 'hps167s --baud 9600 --timeout 200 --count 1',
                                   r'\(9600 8E1\): no byte was received'),
        # Bytes on the line when the simulator learns of the rate may form a frame.
        of_a_sensor_that_sends=('a16 --distance 754', 'a16 --baud 19200 --timeout 500',
                                r'the bytes form no frame of a16.*\(now 19200 8N1; with factory settings 9600 8N1'))
    def wrong_rate(self, device, line, words):
        reader = self.fathom(f'read {line} --port {self.sim(device)}')
        reader.expect(words, 'err')
        done = reader.end()
        self.assertEqual(done.code, 1)
        self.assertLessEqual(done.out.count('mm'), 1)


class Noise(e2e.Case):
    GARBAGE = bytes(byte for byte in random.Random(1).randbytes(4000) if byte != 0xFF)

    def feed(self, sensor, data, until, pause=0.04, timeout=300):
        """A sensor that sends this again and again, with pauses, until the reader says something on
        stderr."""
        device, reader = self.beside(f'read {sensor} --timeout {timeout} --format csv')
        deadline = time.monotonic() + e2e.PATIENCE
        while not re.search(until, reader.said['err'].decode()):
            self.assertLess(time.monotonic(), deadline, f'{until!r} did not come')
            device.write(data)
            reader.has_ended(pause)
        return device, reader

    def test_frames_without_any_pause_whose_beginning_cannot_be_told(self):
        _, reader = self.feed('a16', e2e.frame(511) * 50, 'look like frames of a16, but the start of a frame is not certain',
                              0)
        self.ends(reader.end(), 1)

    def test_a_flood_of_garbage_is_no_reading_and_can_be_ended(self):
        device, reader = self.feed('a16', self.GARBAGE, 'the bytes form no frame of a16', 0)
        os.set_blocking(device.master, False)
        reader.send(signal.SIGINT)
        while not reader.has_ended():  # the flood goes on while it ends
            try:
                device.write(self.GARBAGE)
            except BlockingIOError:
                pass
        self.assertEqual(self.ends(reader, 1).rows, [])

    def test_a_good_frame_after_garbage_is_read(self):
        device, reader = self.feed('a16 --count 2', b'\x12\x34\x56', 'no frame of a16', timeout=2000)
        while not reader.has_ended(0.06):
            device.write(FRAME)
        done = self.ends(reader, 1)
        self.assertEqual(done.out.count(',target,false,1953,1953\n'), 1)


class HangUp(e2e.Case):
    @e2e.each(
        a_sensor_that_sends=('a16::auto', ''),
        a_sensor_that_is_asked=('hps167s::modbus', ''),
        in_a_long_pause_between_two_requests=('hps167s::modbus', '--interval 600000'),
        in_a_long_pause_between_two_frames=('a16::auto', '--interval 600000'))
    def killed(self, device, options):
        sim = self.sim(device, '--distance 754')
        sensor, mode = device.split('::')
        reader = self.fathom(f'read {sensor} --mode {mode} --port {sim} --stats {options}')
        reader.expect('754 mm')
        sim.end(signal.SIGKILL)
        done = self.ends(reader, 1, re.compile(
            rf'(?m)^fathom: attempt \d+: {sim}: the device was unplugged or its far end closed \(.*\)\. '
            rf'Connect it again'), re.compile(r'attempts \d+, failed 1, '))
        self.needs_little(done)

    def test_a_port_that_hangs_up_before_the_first_response(self):
        device, reader = self.beside('read a05 --mode modbus')
        device.read(8)
        device.hang_up()
        self.ends(reader, 1, 'the device was unplugged', out='')


class Signals(e2e.Case):
    @e2e.each(
        interrupt_after_good_readings_is_success=(signal.SIGINT, 0, ''),
        terminate_too=(signal.SIGTERM, 0, ''),
        hang_up_too=(signal.SIGHUP, 0, ''),
        in_a_long_pause=(signal.SIGINT, 0, '--interval 600000'),
        after_a_failure_it_stays_a_failure=(signal.SIGINT, 1, '--address 3 --timeout 100', 'no response',
                                            'err'))
    def ended(self, number, code, options, expect='754 mm', stream='out'):
        reader = self.fathom(f'read hps167s --address 2 --port {self.sim("hps167s:2 --distance 754")} '
                             f'--stats {options}')
        reader.expect(expect, stream)
        self.ends(reader.end(number), code, re.compile(r'(?m)^fathom: attempts [1-9]\d*, failed \d+, readings \d+$'))

    def test_in_the_middle_of_an_attempt(self):
        device, reader = self.beside('read a16 --mode modbus --timeout 600000')
        device.read(8)
        done = self.ends(reader.end(signal.SIGINT), 0, out='')
        self.assertEqual(done.err, '')

    def test_just_before_it_goes_to_sleep(self):
        _, reader = self.beside('read a16 --timeout 600000', env=self.preload('signal_shim.c'))
        self.ends(reader, 0, out='')

    def test_while_the_output_is_not_read(self):
        sim = self.sim('hps167s --distance 754')
        out, pipe = os.pipe()
        self.addCleanup(os.close, out)
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, 4096)
        os.write(pipe, b'x' * 4000)
        reader = self.fathom(f'read hps167s --port {sim} --format json', stdout=pipe)
        os.close(pipe)
        # Blocked in write(2): the system says so.
        deadline = time.monotonic() + e2e.PATIENCE
        while not self.writes(reader) and time.monotonic() < deadline:
            reader.has_ended(0.01)
        self.assertEqual(reader.end(signal.SIGINT).code, 0)

    @staticmethod
    def writes(program):
        try:
            with open(f'/proc/{program.process.pid}/syscall', encoding='ascii') as file:
                return file.read().startswith('1 0x1 ')
        except OSError:  # not allowed here: the wait above ends by its deadline
            return False


class Output(e2e.Case):
    def into(self, pipe, *line):
        """A reader that writes there; here it is closed."""
        reader = self.fathom(*line, stdout=pipe)
        os.close(pipe)
        return reader

    def leaves(self, reader):
        done = reader.finish()
        self.assertEqual((done.code, done.err), (1, ''))
        return done

    def test_a_reader_that_has_seen_enough_ends_it_without_words(self):
        sim = self.sim('hps167s --distance 754')
        out, pipe = os.pipe()
        reader = self.into(pipe, f'read hps167s --port {sim}')
        self.assertIn(b'754 mm', os.read(out, 4000))
        os.close(out)
        self.leaves(reader)

    def test_a_reader_that_was_never_there_ends_it_too(self):
        out, pipe = os.pipe()
        os.close(out)
        self.leaves(self.into(pipe, f'read a16 --port {self.device()} --format csv'))

    def test_also_when_there_is_nothing_to_write(self):
        device = self.device()
        out, pipe = os.pipe()
        reader = self.into(pipe, f'read a16 --mode modbus --port {device} --timeout 600000')
        device.read(8)
        os.close(out)
        self.needs_little(self.leaves(reader))

    def test_a_full_disk_is_told(self):
        sim = self.sim('hps167s --distance 754')
        with open('/dev/full', 'w', encoding='ascii') as full:
            self.ends(f'read hps167s --port {sim}', 1,
                      'the readings cannot be written: No space left on device',
                      stdout=full)

    def shell(self, line, redirections):
        return self.start(['sh', '-c', f'exec "{e2e.FATHOM}" {line} {redirections}'])

    def test_no_output_at_all_never_becomes_the_port(self):
        device = self.device()
        self.ends(self.shell(f'read a16 --port {device}', '>&-'), 1, 'the standard output is closed')
        self.assertEqual(device.rest(), b'')

    def test_closed_input_and_error_output_do_not_matter(self):
        sim = self.sim('hps167s --distance 754')
        done = self.ends(self.shell(f'read hps167s --count 2 --port {sim}', '<&- 2>&-'), 0)
        self.assertEqual(done.out.count('754 mm'), 2)


class Idle(e2e.Case):
    @e2e.each(**{f'waiting_for_a_dead_sensor_takes_next_to_no_cpu_{name}': line for name, line in
                 (('a16', 'a16'), ('a05', 'a05 --mode modbus'))})
    def dead(self, line):
        done = self.ends(f'read {line} --port {self.device()} --timeout 3000 --count 1', 1)
        self.needs_little(done)

    def test_a_pause_between_readings_takes_next_to_no_cpu(self):
        sim = self.sim('hps167s --distance 754')
        done = self.ends(f'read hps167s --port {sim} --interval 1500 --count 3', 0)
        self.needs_little(done, sim.end())


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
