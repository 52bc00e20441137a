#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim with several devices on one line: who answers at which rate, who collides, what the counters say.
Judged in raw bytes, and by `fathom read`."""
import json
import re
import signal
import time

import serial

import e2e

ASK_A16 = bytes.fromhex('01 03 01 00 00 01 85 F6')  # A16 6(4) ex 1
ANSWER_754 = bytes.fromhex('01 03 02 02 F2 38 A1')
ASK_HPS = bytes.fromhex('01 03 00 08 00 04 C5 CB')  # HPS table 17
ANSWER_2083 = bytes.fromhex('01 03 08 08 23 DC B2 07 01 00 00 FD 41')
BUS = ['a16:1:modbus', 'a05:2:modbus', 'hps167s:7']


class Bus(e2e.Case):
    def counters(self, sim):
        """What each device says at the end."""
        lines = sim.end().err.splitlines()
        return [json.loads(line) for line in lines if line.startswith('{')]

    def open(self, sim, **settings):
        port = serial.Serial(sim.port, timeout=e2e.PATIENCE, **settings)
        self.addCleanup(port.close)
        return port

    def ask(self, port, baud, request, length):
        """After the silence that ends whatever a device took for the beginning of a request: 4 ms at 9600 baud."""
        time.sleep(0.02)
        port.baudrate = baud
        port.reset_input_buffer()
        port.write(request)
        return port.read(length)

    def one(self, sim, sensor, *arguments):
        return self.read_json(sensor, '--port', sim.port, '--count', '1', *arguments)[0]['distance_mm']


class Several(Bus):
    def test_three_models_answer_each_at_its_own_address_and_rate(self):
        sim = self.sim(*BUS, '--distance', '1@754', '--distance', '2@316', '--distance', '3@2083', '--counters')
        self.assertEqual(self.one(sim, 'hps167s', '--address', '7'), 2083)
        self.assertEqual(self.one(sim, 'a16', '--mode', 'modbus'), 754)
        self.assertEqual(self.one(sim, 'a05', '--mode', 'modbus', '--address', '2'), 316)
        told = self.counters(sim)
        self.assertEqual([(one['device'], one['sensor'], one['mode'], one['address'], one['baud']) for one in told],
                         [(1, 'a16', 'modbus', 1, 9600), (2, 'a05', 'modbus', 2, 9600), (3, 'hps167s', 'modbus', 7, 19200)])
        self.assertEqual([(one['requests'], one['answered'], one['writes'], one['resets']) for one in told], [(1, 1, 0, 0)] * 3)
        # The answer of the A16 is not for the A05 either; neither understands a byte of the 8 + 13 of the HPS-167S.
        self.assertEqual([one['wrong_settings'] for one in told[:2]], [21, 21])
        self.assertGreaterEqual(told[0]['others'], 1)

    def test_one_option_holds_for_all_and_its_own_wins(self):
        sim = self.sim(*BUS, '--distance', '2@1500', '--distance', '700', '--fault', '3@silence')
        self.assertEqual(self.one(sim, 'a16', '--mode', 'modbus'), 700)
        self.assertEqual(self.one(sim, 'a05', '--mode', 'modbus', '--address', '2'), 1500)
        done = self.run_fathom('read', 'hps167s', '--address', '7', '--port', sim.port, '--count', '1')
        self.assertEqual(done.code, 1, done.out)

    def test_a_fault_for_all_hits_each(self):
        sim = self.sim('a16:1:modbus', 'hps167s:7', '--fault', 'silence', '--counters')
        for arguments in (['a16', '--mode', 'modbus'], ['hps167s', '--address', '7']):
            self.assertEqual(self.run_fathom('read', *arguments, '--port', sim.port, '--count', '1').code, 1)
        self.assertEqual([(one['requests'], one['answered']) for one in self.counters(sim)], [(1, 1)] * 2)

    def test_two_units_with_one_address_answer_into_each_other(self):
        sim = self.sim('hps167s', 'hps167s', '--distance', '1@2083', '--distance', '2@1000', '--counters')
        sim.expect('devices 1 and 2 have the address 1 both', 'err')
        port = self.open(sim, baudrate=19200)
        port.write(ASK_HPS)
        garbled = port.read(13)
        self.assertNotEqual(garbled, ANSWER_2083)
        self.assertNotEqual(e2e.crc16(garbled[:-2]), garbled[-2:])
        told = self.counters(sim)
        self.assertEqual([one['answered'] for one in told], [1, 1])
        self.assertGreater(told[0]['line_collisions'], 10)

    def test_two_units_with_one_address_at_two_rates_do_not_meet(self):
        sim = self.sim('a16:1:modbus', 'hps167s:1', '--distance', '1@754', '--distance', '2@2083', '--counters')
        port = self.open(sim, baudrate=9600)
        for _ in range(2):
            self.assertEqual(self.ask(port, 9600, ASK_A16, 7), ANSWER_754)
            self.assertEqual(self.ask(port, 19200, ASK_HPS, 13), ANSWER_2083)
        self.assertEqual([one['line_collisions'] for one in self.counters(sim)], [0, 0])

    def test_an_hps167s_at_another_rate_is_deaf_at_the_factorys(self):
        sim = self.sim('hps167s:7', '--baud', '115200', '--distance', '2083', '--counters')
        sim.expect(r'115200 8E1, until .*fathom read hps167s --address 7 --baud 115200 --port', 'err')
        self.assertEqual(self.run_fathom('read', 'hps167s', '--address', '7', '--port', sim.port, '--count', '1').code, 1)
        self.assertEqual(self.one(sim, 'hps167s', '--address', '7', '--baud', '115200'), 2083)
        told = self.counters(sim)[0]
        self.assertEqual((told['requests'], told['wrong_settings'], told['baud']), (1, 8, 115200))

    def test_a_rate_for_all_is_for_those_that_can_have_it(self):
        sim = self.sim(*BUS, '--baud', '57600', '--distance', '700')
        self.assertEqual(self.one(sim, 'a16', '--mode', 'modbus'), 700)
        self.assertEqual(self.one(sim, 'hps167s', '--address', '7', '--baud', '57600'), 700)

    def test_local_echo_brings_the_request_back_first(self):
        sim = self.sim('a16::modbus', '--echo', '--distance', '754')
        port = self.open(sim, baudrate=9600)
        port.write(ASK_A16)
        self.assertEqual(port.read(15), ASK_A16 + ANSWER_754)

    def test_the_counters_see_writes_and_resets(self):
        sim = self.sim('a16:1:modbus', 'hps167s:7', '--counters')
        port = self.open(sim, baudrate=9600)
        self.assertEqual(self.ask(port, 9600, e2e.adu(1, 6, 2, 0, 0, 5), 8), bytes.fromhex('01 06 02 00 00 05 48 71'))
        # Another length is no reset but exception 02; then the reset.
        self.assertEqual(self.ask(port, 19200, e2e.adu(7, 3, 0, 9, 0, 2), 5), e2e.adu(7, 0x83, 2))
        self.assertEqual(self.ask(port, 19200, e2e.adu(7, 3, 0, 9, 0, 1), 7), e2e.registers(7, 1))
        a16, hps = self.counters(sim)
        self.assertEqual((a16['writes'], a16['address']), (1, 5))
        self.assertEqual((hps['resets'], hps['resets_refused'], hps['address']), (1, 1, 1))

    def test_without_the_option_there_are_no_counters(self):
        self.assertEqual(self.counters(self.sim('a16')), [])

    def test_the_list_says_how_to_read_each(self):
        sim = self.sim(*BUS, '--distance', '700')
        for number, (sensor, address) in enumerate((('a16', 1), ('a05', 2), ('hps167s', 7)), 1):
            words = sim.expect(rf' {number}  {sensor}, mode modbus, address {address}, .*: fathom (read .*)$', 'err')[1].split()
            self.assertEqual(self.run_fathom(*words, '--count', '1').code, 0, words)

    def test_64_devices_are_one_line(self):
        sim = self.sim(*(f'a16:{address}:modbus' for address in range(1, 65)), '--distance', '700', '--counters')
        self.assertEqual(self.one(sim, 'a16', '--mode', 'modbus', '--address', '64'), 700)
        self.assertEqual([one['requests'] for one in self.counters(sim)], [0] * 63 + [1])

    def test_one_that_sends_by_itself_beside_others_is_told(self):
        sim = self.sim('a16:1:auto', 'hps167s:7', '--distance', '754')
        sim.expect('device 1 sends by itself, into what the others say', 'err')
        self.assertIn(bytes.fromhex('FF 02 F2 F3'), self.open(sim, baudrate=9600).read(12))  # FF + 02 + F2 = 1F3


class Power(Bus):
    def cut(self, sim):
        """Power off; returns at once."""
        sim.send(signal.SIGUSR1)
        sim.expect('power off for a second', 'err')

    def test_nothing_answers_without_power_and_what_is_kept_is_there_afterwards(self):
        sim = self.sim('a16:1:modbus', 'hps167s:7', '--distance', '754', '--counters')
        port = self.open(sim, baudrate=9600)
        self.assertEqual(self.ask(port, 9600, e2e.adu(1, 6, 2, 0, 0, 5), 8), e2e.adu(1, 6, 2, 0, 0, 5))
        self.assertEqual(self.ask(port, 19200, e2e.adu(7, 6, 0, 0x10, 0, 9), 8), e2e.adu(7, 6, 0, 0x10, 0, 9))
        began = time.monotonic()
        self.cut(sim)
        port.timeout = 0.2
        while self.ask(port, 9600, e2e.adu(5, 3, 2, 0, 0, 1), 7) != e2e.registers(5, 5):
            self.assertLess(time.monotonic() - began, e2e.PATIENCE)
        self.assertGreater(time.monotonic() - began, 1)
        port.timeout = e2e.PATIENCE
        self.assertEqual(self.ask(port, 19200, e2e.adu(9, 3, 0, 8, 0, 4), 13)[:5], bytes((9, 3, 8, 2, 0xF2)))
        a16, hps = self.counters(sim)
        self.assertEqual((a16['address'], a16['writes'], a16['flash_writes']), (5, 1, 1))
        self.assertEqual((hps['address'], hps['writes'], hps['flash_writes']), (9, 1, 1))

    def test_an_a05_is_automatic_again_after_it(self):
        sim = self.sim('a05', '--distance', '700', '--counters')
        port = self.open(sim, baudrate=9600)
        self.assertEqual(port.read(10)[0], 0xFF)
        self.one(sim, 'a05', '--mode', 'modbus')  # ends automatic output
        self.cut(sim)
        self.assertEqual(self.one(sim, 'a05'), 700)
        self.assertEqual(self.counters(sim)[0]['requests'], 1)

    def test_it_goes_on_to_run_and_ends_as_always(self):
        sim = self.sim('hps167s', '--distance', '2083')
        for _ in range(3):
            self.cut(sim)
        self.assertEqual(self.one(sim, 'hps167s', '--retries', '9'), 2083)
        self.assertEqual(sim.end().code, 0)


class With(Bus):
    """What the datasheets leave open, byte for byte; without the option first where that differs."""

    def told(self, sensor, request, length, *more):
        """So many bytes of what comes back; 0: what comes in 0.5 s, which is far more than the sensors need."""
        sim = self.sim(sensor, '--distance', '754', *more)
        port = self.open(sim, baudrate=19200 if sensor == 'hps167s' else 9600)
        if length == 0:
            port.timeout = 0.5
        return self.ask(port, port.baudrate, request, length or 1)

    def check(self, sensor, request, answer, *more):
        self.assertEqual(self.told(sensor, request, len(answer), *more), answer)

    def measures(self, sensor, request, *more):
        """A measurement of 754 mm."""
        self.check(sensor, request, e2e.registers(1, 754, 0xDCB2, 0x0701, 0), *more)

    def test_refusals_of_an_a16(self):
        request = e2e.adu(1, 3, 3, 0, 0, 1)
        self.check('a16::modbus', request, b'')
        self.check('a16::modbus', request, e2e.adu(1, 0x83, 2), '--with', 'exceptions')

    def test_answers_to_ff(self):
        request = e2e.adu(255, 3, 2, 0, 0, 1)
        self.check('a05:9:modbus', request, b'')
        self.check('a05:9:modbus', request, e2e.registers(9, 9), '--with', 'broadcast')

    def test_real_time_output_of_an_a16(self):
        request = e2e.adu(1, 3, 2, 7, 0, 1)
        self.check('a16::modbus', request, e2e.registers(1, 0))
        self.check('a16::modbus', request, e2e.registers(1, 1), '--with', 'real-time')

    def test_a_new_address_is_acknowledged_by_the_old_or_the_new(self):
        for sensor, address in (('a16::modbus', (2, 0)), ('a05::modbus', (2, 0)), ('hps167s', (0, 0x10))):
            request = e2e.adu(1, 6, *address, 0, 5)
            self.check(sensor, request, request)
            self.check(sensor, request, e2e.adu(5, 6, *address, 0, 5), '--with', 'new-address')

    def test_the_warm_up_of_an_hps167s(self):
        """255 s: longer than anything here takes."""
        warm = ('--with', 'warm-up=255')
        self.measures('hps167s', ASK_HPS)
        self.check('hps167s', ASK_HPS, b'', *warm)
        self.check('hps167s', ASK_HPS, e2e.adu(1, 0x83, 4), *warm, '--with', 'warm-up-04')
        self.check('hps167s', ASK_HPS, e2e.registers(1, 0xFFFF, 0, 0xFF, 0xFFFF), *warm, '--with', 'warm-up-ff')

    def test_what_the_configuration_says(self):
        request = e2e.adu(1, 3, 0, 2, 0, 4)  # termination, output; warm-up, 180 ms in 32 bits, baud code
        self.check('hps167s', request, e2e.registers(1, 0xFFFF, 0, 0, 0xB401))
        self.check('hps167s', request, e2e.registers(1, 0xFF00, 0, 0, 0xB401), '--with', 'output-off')
        self.check('hps167s', request, e2e.registers(1, 0x00FF, 0x0700, 0, 0xB401), '--with', 'termination-off', '--with', 'warm-up=7')

    def test_unasked_measurements(self):
        self.check('hps167s', b'', b'')
        self.measures('hps167s', b'', '--with', 'unasked=100')

    def test_a_wrong_length_is_refused_by_02_or_03(self):
        request = e2e.adu(1, 3, 0, 8, 0, 3)
        self.check('hps167s', request, e2e.adu(1, 0x83, 2))
        self.check('hps167s', request, e2e.adu(1, 0x83, 3), '--with', 'count-03')

    def test_an_offset_replaces_or_adds(self):
        for words, distance in (((), 764), (('--with', 'offset-adds'), 774)):
            sim = self.sim('hps167s', '--distance', '754', *words)
            port = self.open(sim, baudrate=19200)
            for _ in range(2):
                self.ask(port, 19200, e2e.adu(1, 6, 0, 0x14, 0, 10), 8)
            self.assertEqual(self.ask(port, 19200, ASK_HPS, 13)[3:5], distance.to_bytes(2, 'big'))

    def test_a_new_rate_acts_at_once_or_after_the_next_power_on(self):
        request = e2e.adu(1, 6, 0, 0x11, 0, 3)
        for words, rate in (((), 115200), (('--with', 'baud-later'), 19200)):
            sim = self.sim('hps167s', *words)
            port = self.open(sim, baudrate=19200)
            self.assertEqual(self.ask(port, 19200, request, 8), request)
            self.assertEqual(len(self.ask(port, rate, ASK_HPS, 13)), 13)
            sim.send(signal.SIGUSR1)
            sim.expect('power off', 'err')
            port.timeout = 0.2
            began = time.monotonic()
            while len(self.ask(port, 115200, ASK_HPS, 13)) != 13:
                self.assertLess(time.monotonic() - began, e2e.PATIENCE)

    def test_for_all_means_those_that_can_and_n_means_one(self):
        sim = self.sim(*BUS, '--with', 'exceptions', '--with', '3@count-03')
        port = self.open(sim, baudrate=9600)
        self.assertEqual(self.ask(port, 9600, e2e.adu(1, 3, 3, 0, 0, 1), 5), e2e.adu(1, 0x83, 2))
        self.assertEqual(self.ask(port, 9600, e2e.adu(2, 3, 3, 0, 0, 1), 5), e2e.adu(2, 0x83, 2))
        self.assertEqual(self.ask(port, 19200, e2e.adu(7, 3, 0, 8, 0, 3), 5), e2e.adu(7, 0x83, 3))


class Wrong(e2e.Case):
    def wrong(self, words, *arguments):
        done = self.run_fathom('sim', *arguments)
        self.assertEqual((done.code, done.out), (2, ''), done.err)
        self.assertEqual(len(done.err.splitlines()), 1, done.err)
        self.assertIn(words, done.err)

    def test_two_that_send_by_themselves_are_refused(self):
        self.wrong('a16 and a05 would both send by themselves', 'a16', 'hps167s:2', 'a05')

    def test_more_than_64_are_refused(self):
        self.wrong('up to 64 devices a line, not 65', *['a16:1:modbus'] * 65)

    def test_a_device_that_is_not_there_is_refused(self):
        for place in ('0', '4', '99999999'):
            self.wrong(f'--distance {place}@5 is for a device that is not there; they count from 1 to 3',
                       *BUS, '--distance', f'{place}@5')
        self.wrong('--fault 2@silence is for a device that is not there; they count from 1 to 1', 'a16', '--fault', '2@silence')

    def test_what_one_of_them_cannot_have_is_refused(self):
        self.wrong("there is no fault 'interference' for hps167s", *BUS, '--fault', 'interference')
        self.wrong("--distance '1,2' is more than the 1 of a16", *BUS, '--distance', '1,2')
        self.wrong('a16 has one baud rate only', *BUS, '--baud', '1@19200')
        self.wrong('a16 has one baud rate only', 'a16', '--baud', '9600')
        self.wrong('a05 has one baud rate only', 'a05', 'a16::modbus', '--baud', '19200')

    def test_a_rate_that_an_hps167s_does_not_have_is_refused(self):
        for rate in ('9600', '38400', '19200x', '', '0'):
            self.wrong(f"--baud of hps167s takes 19200, 57600, 115200 or 230400, not '{rate}'", 'hps167s', '--baud', rate)

    def test_what_none_of_them_has_is_refused(self):
        self.wrong("there is no 'unasked' for a16, only exceptions, broadcast, real-time, new-address", 'a16', '--with', 'unasked=5')
        self.wrong("there is no 'count-03' for a16", *BUS, '--with', '1@count-03')
        self.wrong("there is no 'x' for a16", *BUS, '--with', 'x')
        for value in ('warm-up', 'warm-up=', 'warm-up=0', 'warm-up=256', 'warm-up=1s'):
            self.wrong(f"--with takes warm-up=S, a whole number from 1 to 255, not '{value}'", 'hps167s', '--with', value)
        self.wrong("--with count-03 takes no value, so not 'count-03=1'", 'hps167s', '--with', 'count-03=1')

    def test_the_help_names_it_all(self):
        text = self.run_fathom('sim', '--help').out
        for word in ('SENSOR[:ADDRESS[:MODE]]...', '--baud', '--echo', '--counters', '--with', 'warm-up=S', 'N@', '64', 'SIGUSR1'):
            self.assertIn(word, text)
        self.assertEqual([line for line in text.splitlines() if re.search('.{125}', line)], [])


if __name__ == '__main__':
    e2e.main()
