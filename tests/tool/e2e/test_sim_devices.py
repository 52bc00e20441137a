#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim as a program: its path, its link, its end, and what it sends; with several devices on one line:
who answers at which rate, who collides, what the counters say; with faults: its errors, and what a client
sees of them. Judged in raw bytes through pyserial, and by `fathom read`. It needs real time: CTest runs one such file at a time."""
import os
import re
import signal
import time

import serial

import e2e
from e2e import ASK_A16, ASK_HPS, SAYS_754, SAYS_2083

BUS = 'a16:1:modbus a05:2:modbus hps167s:7'
A16, A05, HPS = 'a16 --mode modbus', 'a05 --mode modbus --address 2', 'hps167s --address 7'


class Case(e2e.Case):
    def open(self, sim, baudrate=None):
        """At the rate of its first device, where none is given."""
        rate = baudrate or (19200 if sim.command[2].startswith('hps167s') else 9600)
        port = serial.Serial(sim.port, timeout=e2e.PATIENCE, baudrate=rate)
        self.addCleanup(port.close)
        return port

    def ask(self, port, request, length, baud=None):
        """After 10 times the silence that ends whatever a device took for the beginning of a request: 4 ms at 9600
        baud."""
        time.sleep(0.04)
        port.baudrate = baud or port.baudrate
        port.reset_input_buffer()
        port.write(request)
        return port.read(length)

    def counters(self, sim, *names):
        """What each device says of these at the end."""
        return [tuple(one[name] for name in names) for one in sim.end().told]


class Link(Case):
    def setUp(self):
        super().setUp()
        self.link = self.path('tof')

    def test_the_path_is_the_only_line_of_stdout_and_the_link_is_there_by_then(self):
        sim = self.sim(f'hps167s --link {self.link}')
        self.assertEqual(os.readlink(self.link), sim.port)
        sim.expect('simulates hps167s, mode modbus, address 1, 19200 8E1.*fathom read hps167s:1:modbus --port '
                   f'{self.link}$', 'err')
        self.ends(sim.end(), 0, out=f'{sim.port}\n')

    def test_the_link_goes_with_every_end_that_can_be_seen(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            sim = self.sim(f'hps167s --link {self.link}')
            self.assertTrue(os.path.islink(self.link))
            self.assertEqual(sim.end(number).code, 0)
            self.assertFalse(os.path.lexists(self.link))

    def test_a_link_that_was_left_behind_is_replaced(self):
        sim = self.sim(f'a16 --link {self.link}')
        sim.send(signal.SIGKILL)
        sim.finish()
        self.assertTrue(os.path.lexists(self.link))
        os.unlink(self.link)
        os.symlink('/dev/pts/99999999', self.link)  # because another test may have got its number by now
        sim = self.sim(f'a16 --distance 754 --link {self.link}')
        self.assertEqual(self.read_json(f'a16 --port {self.link} --count 1')[0]['distance_mm'], 754)
        sim.end()
        self.assertFalse(os.path.lexists(self.link))

    def test_what_is_the_users_is_neither_replaced_nor_removed(self):
        refused = (f'sim a16 --link {self.link}', 1,
                   f'fathom: {self.link} exists, and is not the link of a killed fathom sim')
        first = self.sim(f'a16 --link {self.link}')
        self.ends(*refused, out='')
        self.assertEqual(os.readlink(self.link), first.port)
        for target in ('/', '/dev/ttyUSB_none'):
            os.unlink(self.link)
            os.symlink(target, self.link)
            self.ends(*refused, out='')
        self.assertEqual(first.end().code, 0)
        self.assertEqual(os.readlink(self.link), target)
        os.unlink(self.link)
        with open(self.link, 'w', encoding='ascii') as file:
            file.write('precious')
        self.ends(*refused, out='')
        with open(self.link, encoding='ascii') as file:
            self.assertEqual(file.read(), 'precious')

    def test_a_folder_that_is_not_there_is_told(self):
        self.ends(f'sim a16 --link {self.path("no/tof")}', 1, re.compile(
            r'^fathom: cannot make the simulated port and its link .*/no/tof: No such file or directory\n$'), out='')

    def test_the_hint_names_what_is_not_the_factorys(self):
        sim = self.sim('a16:7:modbus')
        sim.expect(rf'fathom read a16:7:modbus --port {sim}$', 'err')


class Program(Case):
    def test_it_moves_by_itself_and_starts_where_the_seed_says(self):
        seen = []
        for seed in (0, 2000000):  # 2 s further in the movement; reading takes much less
            sim = self.sim(f'hps167s --seed {seed}')
            distances = [one['distance_mm'] for one in self.read_json(f'hps167s --port {sim} --count 10')]
            self.assertEqual(distances, sorted(set(distances)))
            self.assertTrue(500 <= distances[0] and distances[-1] <= 12000, distances)
            seen.append(distances)
        self.assertGreater(seen[1][0], seen[0][0])

    def test_it_sleeps_without_requests(self):
        sim = self.sim('hps167s')
        self.assertFalse(sim.has_ended(1.9))
        done = sim.end()
        self.needs_little(done)
        self.assertEqual(done.told, []) # no counters without the option

    def test_it_goes_on_when_its_stdout_is_not_read(self):
        out, pipe = os.pipe()
        sim = self.fathom('sim a16 --distance 754', stdout=pipe)
        os.close(pipe)
        with os.fdopen(out) as stdout:
            port = stdout.readline().strip()
        self.assertEqual(self.read_json(f'a16 --port {port} --count 2')[1]['distance_mm'], 754)
        self.assertEqual(sim.end().code, 0)


class Several(Case):
    def mm(self, sim, sensor, options=''):
        return self.read_json(f'{sensor} --port {sim} --count 1 {options}')[0]['distance_mm']

    def fails(self, sim, sensor):
        self.ends(f'read {sensor} --port {sim} --count 1', 1)

    def test_three_models_answer_each_at_its_own_address_and_rate(self):
        sim = self.sim('a16:1:modbus,distance=754 a05:2:modbus,distance=316 hps167s:7,distance=2083 --counters')
        for number, (sensor, address, mm) in enumerate((('a16', 1, 754), ('a05', 2, 316), ('hps167s', 7, 2083)), 1):
            line = sim.expect(rf' {number}  {sensor}, mode modbus, address {address}, .*: fathom (read .*)$', 'err')[1]
            self.assertIn(f'{mm} mm', self.ends(f'{line} --count 1', 0).out)
        told = self.counters(sim, 'device', 'model', 'mode', 'address', 'baud', 'requests', 'answered', 'writes', 'resets',
                             'wrong_settings', 'others')
        self.assertEqual([one[:9] for one in told], [(1, 'a16', 'modbus', 1, 9600, 1, 1, 0, 0),
                                                     (2, 'a05', 'modbus', 2, 9600, 1, 1, 0, 0),
                                                     (3, 'hps167s', 'modbus', 7, 19200, 1, 1, 0, 0)])
        # The response of the A16 is not for the A05 either; neither understands a byte of the 8 + 13 of the HPS-167S.
        self.assertEqual([one[9] for one in told[:2]], [21, 21])
        self.assertGreaterEqual(told[0][10], 1)

    def test_options_apply_to_all_and_a_key_behind_a_sensor_to_that_sensor(self):
        sim = self.sim('a16:1:modbus a05:2:modbus,distance=1500 hps167s:7,fault=silence --distance 700')
        self.assertEqual([self.mm(sim, sensor) for sensor in (A16, A05)], [700, 1500])
        self.fails(sim, HPS)
        sim = self.sim('a16:1:modbus hps167s:7 --fault silence --counters')
        for sensor in (A16, HPS):
            self.fails(sim, sensor)
        self.assertEqual(self.counters(sim, 'requests', 'answered'), [(1, 1)] * 2)

    def test_two_units_with_one_address_answer_into_each_other(self):
        sim = self.sim('hps167s,distance=2083 hps167s,distance=1000 --counters')
        sim.expect('sensors 1 and 2 both have address 1', 'err')
        garbled = self.ask(self.open(sim), ASK_HPS, 13)
        self.assertNotEqual(garbled, SAYS_2083)
        self.assertNotEqual(e2e.crc16(garbled[:-2]), garbled[-2:])
        (answered, collisions), (other_answered, _) = self.counters(sim, 'answered', 'line_collisions')
        self.assertEqual((answered, other_answered), (1, 1))
        self.assertGreater(collisions, 10)

    def test_a_rate_for_all_is_for_those_that_can_have_it(self):
        sim = self.sim(f'{BUS} --baud 57600 --distance 700')
        sim.expect(r'57600 8E1: fathom read hps167s:7:modbus --port .* --baud 57600', 'err')
        self.fails(sim, HPS)
        self.assertEqual(self.mm(sim, A16), 700)
        self.assertEqual(self.mm(sim, HPS, '--baud 57600'), 700)

    def test_the_counters_see_writes_and_resets(self):
        sim = self.sim('a16:1:modbus hps167s:7 --counters')
        port = self.open(sim)
        self.assertEqual(self.ask(port, e2e.adu(1, 6, 2, 0, 0, 5), 8, 9600), bytes.fromhex('01 06 02 00 00 05 48 71'))
        # Another length is no reset but exception 02; then the reset.
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 9, 0, 2), 5, 19200), e2e.adu(7, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 9, 0, 1), 7, 19200), e2e.registers(7, 1))
        self.assertEqual(self.counters(sim, 'writes', 'address', 'resets', 'resets_refused'),
                         [(1, 5, 0, 0), (0, 1, 1, 1)])

    def test_64_devices_are_one_line(self):
        sim = self.sim(' '.join(f'a16:{address}:modbus' for address in range(1, 65)), '--distance 700 --counters')
        self.assertEqual(self.mm(sim, A16, '--address 64'), 700)
        self.assertEqual(self.counters(sim, 'requests'), [(0,)] * 63 + [(1,)])

    def test_one_that_sends_by_itself_beside_others_is_told(self):
        sim = self.sim('a16:1:auto hps167s:7 --distance 754')
        sim.expect('sensor 1 sends automatically, into the frames of the others', 'err')
        self.assertIn(bytes.fromhex('FF 02 F2 F3'), self.open(sim).read(12))  # FF + 02 + F2 = 1F3


    def test_nothing_answers_without_power_and_what_is_kept_is_there_afterwards(self):
        sim = self.sim('a16:1:modbus hps167s:7 --distance 754 --counters')
        port = self.open(sim)
        for request, baud in ((e2e.adu(1, 6, 2, 0, 0, 5), 9600), (e2e.adu(7, 6, 0, 0x10, 0, 9), 19200)):
            self.assertEqual(self.ask(port, request, 8, baud), request)
        began = time.monotonic()
        sim.send(signal.SIGUSR1)
        sim.expect('power off for a second', 'err')
        port.timeout = 0.2
        while self.ask(port, e2e.adu(5, 3, 2, 0, 0, 1), 7, 9600) != e2e.registers(5, 5):
            self.assertLess(time.monotonic() - began, e2e.PATIENCE)
        self.assertGreater(time.monotonic() - began, 1)
        port.timeout = e2e.PATIENCE
        self.assertEqual(self.ask(port, e2e.adu(9, 3, 0, 8, 0, 4), 13, 19200)[:5], bytes((9, 3, 8, 2, 0xF2)))
        self.assertEqual(self.counters(sim, 'address', 'writes', 'flash_writes'), [(5, 1, 1), (9, 1, 1)])


THE_A05S = e2e.adu(1, 3, 1, 7, 0, 3), bytes.fromhex('01 03 06 00 FA 02 93 09 7A 8F 47')
NO_SUCH_REGISTER, WRONG_LENGTH = e2e.adu(1, 3, 3, 0, 0, 1), e2e.adu(1, 3, 0, 8, 0, 3)
BROADCAST, DATA_TYPE = e2e.adu(255, 3, 2, 0, 0, 1), e2e.adu(1, 3, 2, 7, 0, 1)
NEW_ADDRESS, NEW_ADDRESS_OF_HPS = e2e.adu(1, 6, 2, 0, 0, 5), e2e.adu(1, 6, 0, 0x10, 0, 5)
CONFIGURATION = e2e.adu(1, 3, 0, 2, 0, 4)  # termination, output; warm-up, 180 ms in 32 bits, baud code
OFFSET, RATE = e2e.adu(1, 6, 0, 0x14, 0, 10), e2e.adu(1, 6, 0, 0x11, 0, 3)
WARM = 'hps167s --with warm-up=255'  # s: longer than anything here takes


def measured(mm):
    return e2e.registers(1, mm, 0xDCB2, 0x0701, 0)


class Bytes(Case):
    """What is sent byte for byte: the frames of the datasheets, and what the datasheets leave open; without the option
    first where that differs."""

    @e2e.each(
        an_a16_sends_the_datasheets_frame=(b'', ('a16 --distance 1953', bytes.fromhex('FF 07 A1 A7'))),
        an_a05_sends_the_datasheets_frame=(
            b'', ('a05 --distance 1000,2000,1953,3562', bytes.fromhex('FF 03 E8 07 D0 07 A1 0D EA 60'))),
        an_a16_answers_as_in_the_datasheet=(ASK_A16, ('a16::modbus', SAYS_754)),
        an_a05_answers_as_in_the_datasheet=(THE_A05S[0], ('a05::modbus --distance 100,250,659,2426', THE_A05S[1])),
        an_hps167s_answers_as_in_the_datasheet=(ASK_HPS, ('hps167s --distance 2083', SAYS_2083)),
        local_echo_brings_the_request_back_first=(ASK_A16, ('a16::modbus --echo', ASK_A16 + SAYS_754)),
        two_faults_at_once=(ASK_A16, ('a16::modbus --fault echo --fault duplicate=100%', ASK_A16 + SAYS_754 + SAYS_754)),
        a_marked_byte_comes_as_a_terminal_gives_it=(b'', ('a16 --fault break', b'\0' + e2e.frame(754))),
        refusals_of_an_a16=(NO_SUCH_REGISTER, ('a16::modbus', b''),
                            ('a16::modbus --with exceptions', e2e.adu(1, 0x83, 2))),
        answers_to_ff=(BROADCAST, ('a05:9:modbus', b''), ('a05:9:modbus --with broadcast', e2e.registers(9, 9))),
        real_time_output_of_an_a16=(DATA_TYPE, ('a16::modbus', e2e.registers(1, 0)),
                                    ('a16::modbus --with real-time', e2e.registers(1, 1))),
        a_new_address_is_acknowledged_by_the_old_or_the_new=(
            NEW_ADDRESS, ('a16::modbus', NEW_ADDRESS), ('a05::modbus', NEW_ADDRESS),
            ('a16::modbus --with new-address', e2e.adu(5, 6, 2, 0, 0, 5)),
            ('a05::modbus --with new-address', e2e.adu(5, 6, 2, 0, 0, 5))),
        a_new_address_of_an_hps167s_is_acknowledged_by_the_old_or_the_new=(
            NEW_ADDRESS_OF_HPS, ('hps167s', NEW_ADDRESS_OF_HPS),
            ('hps167s --with new-address', e2e.adu(5, 6, 0, 0x10, 0, 5))),
        the_warm_up_of_an_hps167s=(ASK_HPS, ('hps167s', measured(754)), (WARM, b''),
                                   (f'{WARM} --with warm-up-04', e2e.adu(1, 0x83, 4)),
                                   (f'{WARM} --with warm-up-ff', e2e.registers(1, 0xFFFF, 0, 0xFF, 0xFFFF))),
        what_the_configuration_says=(
            CONFIGURATION, ('hps167s', e2e.registers(1, 0xFFFF, 0, 0, 0xB401)),
            ('hps167s --with output-off', e2e.registers(1, 0xFF00, 0, 0, 0xB401)),
            ('hps167s --with termination-off --with warm-up=7', e2e.registers(1, 0x00FF, 0x0700, 0, 0xB401))),
        unasked_measurements=(b'', ('hps167s', b''), ('hps167s --with unasked=100', measured(754))),
        a_wrong_length_is_refused_by_02_or_03=(WRONG_LENGTH, ('hps167s', e2e.adu(1, 0x83, 2)),
                                               ('hps167s --with count-03', e2e.adu(1, 0x83, 3))))
    def said(self, request, *rows):
        for device, response in rows:
            sim = self.sim(device, '' if '--distance' in device else '--distance 754')
            port = self.open(sim)
            if not response:
                port.timeout = 0.5  # far more than the sensors need
            if response and not request: # sent by itself, perhaps in the middle at first
                self.assertIn(response, port.read(2 * len(response)), device)
            else:
                self.assertEqual(self.ask(port, request, len(response) or 1), response, device)

    @e2e.each(an_offset_replaces=('', (OFFSET, OFFSET, 19200), (OFFSET, OFFSET, 19200), (ASK_HPS, measured(764), 19200)),
              an_offset_replaces_or_adds=('--with offset-adds', (OFFSET, OFFSET, 19200), (OFFSET, OFFSET, 19200),
                                          (ASK_HPS, measured(774), 19200)),
              a_new_rate_acts_at_once=('', (RATE, RATE, 19200), (ASK_HPS, measured(754), 115200)),
              a_new_rate_acts_at_once_or_after_the_next_power_on=('--with baud-later', (RATE, RATE, 19200),
                                                                  (ASK_HPS, measured(754), 19200)))
    def talk(self, options, *steps):
        port = self.open(self.sim(f'hps167s --distance 754 {options}'))
        for request, response, baud in steps:
            self.assertEqual(self.ask(port, request, len(response), baud), response)

    def test_an_option_applies_to_the_sensors_that_can_have_it_and_keys_add_to_it(self):
        port = self.open(self.sim(f'{BUS},with=count-03 --with exceptions'))
        self.assertEqual(self.ask(port, NO_SUCH_REGISTER, 5, 9600), e2e.adu(1, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(2, 3, 3, 0, 0, 1), 5, 9600), e2e.adu(2, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 8, 0, 3), 5, 19200), e2e.adu(7, 0x83, 3))

    def test_each_module_that_has_a_line_is_read_by_its_name(self):
        rows = [row for row in self.run_fathom('models --format json').all_json if row['line']]
        self.assertGreater(len(rows), 45)
        for row in rows:
            name, mode = row['model'], row['mode']
            self.assertTrue(row['min_mm'] <= 1000 <= row['max_mm'], name)
            sim = self.sim(f'{name}:1:{mode} --distance 1000')
            for _ in range(5):  # a response within 13 ms may be late on a busy machine, and not every time
                done = self.run_fathom(f'read {name}:1:{mode} --port {sim} --count 2 --format json')
                told = [one['distance_mm'] for one in done.json if one['status'] == 'target']
                if told:
                    break
            self.assertEqual(set(told), {1000}, (name, mode, done))
            self.assertEqual({one['model'] for one in done.json}, {name})
            sim.end()

    def test_a_sensor_may_have_32_faults(self):
        self.assertEqual(self.sim('a16', '--fault drop=1% ' * 32).end().code, 0)


if __name__ == '__main__':
    e2e.main()
