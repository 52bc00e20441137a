#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom scan as a program: its bar on a terminal, Ctrl-C, a port that is lost, a pipe that closes, and that the
command which it prints reads the sensor. What it finds and says is in test_tool_scan*.c, in simulated time."""
import os
import pty
import re
import shlex
import signal
import termios

import e2e

# Far more than a simulated sensor takes on a busy machine; so that load makes it slow, not wrong.
PATIENT = '--listen 1 --timeout 500'


class Case(e2e.Case):
    def test_the_printed_command_reads_each_sensor(self):
        sim = self.sim('a16:11:modbus a05:12:modbus hps167s:13,baud=57600 --distance 1234')
        done = self.ends(f'scan --port {sim} --format json --address 11-13 --baud 9600,57600 {PATIENT}', 0)
        self.assertEqual([one['address'] for one in done.json], [11, 12, 13])
        for one in done.json:
            self.assertEqual(self.read_json(one['next'][12:], '--count 1 --timeout 5000')[0]['distance_mm'], 1234)

    def test_one_finds_the_unit_that_responds_at_address_255_and_stops(self):
        sim = self.sim('a16:200:modbus,with=broadcast hps167s:1 --distance 1234')
        one, = self.ends(f'scan --port {sim} --format json --one {PATIENT}', 0, '. --one ended the scan').json
        self.assertEqual([one['address'], one['distance_mm'], one['is_certain']], [200, 1234, True])
        self.assertEqual(self.read_json(one['next'][12:], '--count 1 --timeout 5000')[0]['distance_mm'], 1234)

    def test_a_soil_probe_is_named_and_is_no_sensor(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --address 7 --baud 9600 --format json {PATIENT}')
        device.asked(e2e.adu(255, 3, 2, 0, 0, 1))
        for register, response in ((0x0200, (0x83, 2)), (0x0100, (3, 2, 0, 7)), (0x0101, (3, 2, 0, 2))):
            device.asked(e2e.adu(7, 3, register >> 8, register & 255, 0, 1), e2e.adu(7, *response))
        found, = self.ends(program, 1).json
        self.assertEqual([found['kind'], found['address'], found['model']], ['other_modbus', 7, None])
        self.assertTrue(found['perhaps'].startswith('probably a soil probe: '))

    def test_a_soil_probe_that_is_silent_at_0200_is_named_too(self):
        """The response 01 03 04 00 01 00 02 2A 32 of a public soil probe, in two: address 1, code 2 for 9600 baud."""
        device = self.device()
        program = self.fathom(f'scan --port {device} --address 1 --baud 9600 --format json {PATIENT}')
        device.asked(e2e.adu(255, 3, 2, 0, 0, 1))
        device.asked(e2e.adu(1, 3, 2, 0, 0, 1))
        for register, value in ((0x0100, 1), (0x0100, 1), (0x0101, 2)):
            device.asked(e2e.adu(1, 3, register >> 8, register & 255, 0, 1), e2e.registers(1, value))
        found, = self.ends(program, 1).json
        self.assertEqual([found['kind'], found['address'], found['model']], ['other_modbus', 1, None])
        self.assertTrue(found['perhaps'].startswith('probably a soil probe: '))

    def test_the_printed_command_quotes_the_port_for_a_shell(self):
        self.sim(['hps167s:7', '--link', self.path("it's here")])
        done = self.ends(['scan', '--port', self.path("it's here"),
                          *f'--address 7 --baud 19200 {PATIENT}'.split()], 0)
        self.assertNotIn('\r', done.out + done.err)
        words = shlex.split(done.out.split('->')[1])
        self.assertEqual(words[4], self.path("it's here"))
        self.assertEqual(self.read_json(words[2:], '--count 1')[0]['address'], 7)

    def test_the_plan_is_printed_before_the_first_request(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --address 1-2 --listen 1')
        program.expect('^fathom: listens for .*addresses 1 to 2 at 9600 8N1, 19200 8E1: about ', 'err')
        device.asked(e2e.adu(255, 3, 2, 0, 0, 1))  # A16 6: the address register, which measures nothing
        self.assertEqual(device.baud(), termios.B9600)
        self.ends(program, 1)

    def test_a_terminal_has_a_bar_that_is_removed(self):
        sim = self.sim('hps167s:2')
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        attributes = termios.tcgetattr(slave)
        attributes[1] &= ~termios.OPOST
        termios.tcsetattr(slave, termios.TCSANOW, attributes)
        program = self.fathom(f'scan --port {sim} --address 1-4 {PATIENT}', stderr=slave)
        os.close(slave)
        said = b''
        while e2e.is_ready(master, e2e.PATIENCE):
            try:
                said += os.read(master, 4096)
            except OSError:  # the last writer has gone
                break
        done = program.finish()
        self.assertEqual(done.code, 0, said)
        self.assertNotIn('\r', done.out)
        self.assertEqual(len(done.out.splitlines()), 1)
        bars = re.findall(rb'\r\[([#.]{24})\] +(\d+) %  ([^\r]*?), (\d+) s left\x1b\[K', said)
        self.assertGreater(len(bars), 5)
        self.assertEqual(bars[0][2], b'listens')
        self.assertRegex(bars[-1][2], rb'^(9600 8N1|19200 8E1) address \d$')
        self.assertEqual([int(bar[1]) for bar in bars], sorted(int(bar[1]) for bar in bars))
        for filled, percent, _, _ in bars:
            self.assertEqual(filled.count(b'#'), int(percent) * 24 // 100)
        shown = said.decode().split('\x1b[K')[-1]
        self.assertRegex(shown, r'^fathom: sensors found: 1, after \d+ s\n$')

    def test_a_lost_port_ends_the_scan(self):
        device = self.device()
        program = self.fathom(f'scan --port {device} --listen 1')
        device.read(8)
        device.hang_up()
        self.ends(program, 1, re.compile(r'Connect it again and start again.*\n\Z'))

    def test_ctrl_c_keeps_what_was_found(self):
        program = self.fathom(f'scan --port {self.sim("hps167s:1")} --baud 19200 --address 1-254 {PATIENT}')
        program.expect('^hps167s +address 1 ')
        self.ends(program.end(signal.SIGINT), 0, 'the scan ended before its last address. Sensors found: 1')

    def test_a_closed_pipe_ends_the_scan(self):
        sim = self.sim('hps167s:1 hps167s:2')
        out, pipe = os.pipe()
        program = self.fathom(f'scan --port {sim} --baud 19200 --address 1-254 {PATIENT}', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            self.assertIn('address 1 ', stdout.readline())
        self.ends(program, 1)  # in 20 s, and all addresses take 2 minutes


if __name__ == '__main__':
    e2e.main(at_once=8)  # they wait for time-outs
