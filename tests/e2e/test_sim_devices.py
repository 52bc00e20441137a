#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom sim with several devices on one line: who answers at which rate, who collides, what the counters
say. Judged in raw bytes, and by `fathom read`."""
import signal
import time

import e2e
from e2e import ASK_A16, ASK_HPS, SAYS_754, SAYS_2083
from simulated import Case

BUS = 'a16:1:modbus a05:2:modbus hps167s:7'
A16, A05, HPS = 'a16 --mode modbus', 'a05 --mode modbus --address 2', 'hps167s --address 7'


class Bus(Case):
    def mm(self, sim, sensor, options=''):
        return self.read_json(f'{sensor} --port {sim} --count 1 {options}')[0]['distance_mm']

    def fails(self, sim, sensor):
        self.ends(f'read {sensor} --port {sim} --count 1', 1)


class Several(Bus):
    def test_three_models_answer_each_at_its_own_address_and_rate(self):
        sim = self.sim(f'{BUS} --distance 1@754 --distance 2@316 --distance 3@2083 --counters')
        self.assertEqual([self.mm(sim, sensor) for sensor in (HPS, A16, A05)], [2083, 754, 316])
        told = self.counters(sim, 'device', 'sensor', 'mode', 'address', 'baud', 'requests', 'answered',
                             'writes',
                             'resets', 'wrong_settings', 'others')
        self.assertEqual([one[:9] for one in told], [(1, 'a16', 'modbus', 1, 9600, 1, 1, 0, 0),
                                                     (2, 'a05', 'modbus', 2, 9600, 1, 1, 0, 0),
                                                     (3, 'hps167s', 'modbus', 7, 19200, 1, 1, 0, 0)])
        # The answer of the A16 is not for the A05 either; neither understands a byte of the 8 + 13 of the
        # HPS-167S.
        self.assertEqual([one[9] for one in told[:2]], [21, 21])
        self.assertGreaterEqual(told[0][10], 1)

    def test_one_option_holds_for_all_and_its_own_wins(self):
        sim = self.sim(f'{BUS} --distance 2@1500 --distance 700 --fault 3@silence')
        self.assertEqual([self.mm(sim, sensor) for sensor in (A16, A05)], [700, 1500])
        self.fails(sim, HPS)

    def test_a_fault_for_all_hits_each(self):
        sim = self.sim('a16:1:modbus hps167s:7 --fault silence --counters')
        self.fails(sim, A16)
        self.fails(sim, HPS)
        self.assertEqual(self.counters(sim, 'requests', 'answered'), [(1, 1)] * 2)

    def test_two_units_with_one_address_answer_into_each_other(self):
        sim = self.sim('hps167s hps167s --distance 1@2083 --distance 2@1000 --counters')
        sim.expect('devices 1 and 2 have the address 1 both', 'err')
        garbled = self.ask(self.open(sim), ASK_HPS, 13)
        self.assertNotEqual(garbled, SAYS_2083)
        self.assertNotEqual(e2e.crc16(garbled[:-2]), garbled[-2:])
        (answered, collisions), (other_answered, _) = self.counters(sim, 'answered', 'line_collisions')
        self.assertEqual((answered, other_answered), (1, 1))
        self.assertGreater(collisions, 10)

    def test_two_units_with_one_address_at_two_rates_do_not_meet(self):
        sim = self.sim('a16:1:modbus hps167s:1 --distance 1@754 --distance 2@2083 --counters')
        port = self.open(sim)
        for _ in range(2):
            self.assertEqual(self.ask(port, ASK_A16, 7, 9600), SAYS_754)
            self.assertEqual(self.ask(port, ASK_HPS, 13, 19200), SAYS_2083)
        self.assertEqual(self.counters(sim, 'line_collisions'), [(0,)] * 2)

    def test_an_hps167s_at_another_rate_is_deaf_at_the_factorys(self):
        sim = self.sim('hps167s:7 --baud 115200 --distance 2083 --counters')
        sim.expect(r'115200 8E1, until .*fathom read hps167s --address 7 --baud 115200 --port', 'err')
        self.fails(sim, HPS)
        self.assertEqual(self.mm(sim, HPS, '--baud 115200'), 2083)
        self.assertEqual(self.counters(sim, 'requests', 'wrong_settings', 'baud'), [(1, 8, 115200)])

    def test_a_rate_for_all_is_for_those_that_can_have_it(self):
        sim = self.sim(f'{BUS} --baud 57600 --distance 700')
        self.assertEqual(self.mm(sim, A16), 700)
        self.assertEqual(self.mm(sim, HPS, '--baud 57600'), 700)

    def test_local_echo_brings_the_request_back_first(self):
        sim = self.sim('a16::modbus --echo --distance 754')
        self.assertEqual(self.ask(self.open(sim), ASK_A16, 15), ASK_A16 + SAYS_754)

    def test_the_counters_see_writes_and_resets(self):
        sim = self.sim('a16:1:modbus hps167s:7 --counters')
        port = self.open(sim)
        self.assertEqual(self.ask(port, e2e.adu(1, 6, 2, 0, 0, 5), 8, 9600),
                         bytes.fromhex('01 06 02 00 00 05 48 71'))
        # Another length is no reset but exception 02; then the reset.
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 9, 0, 2), 5, 19200), e2e.adu(7, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 9, 0, 1), 7, 19200), e2e.registers(7, 1))
        self.assertEqual(self.counters(sim, 'writes', 'address', 'resets', 'resets_refused'),
                         [(1, 5, 0, 0), (0, 1, 1, 1)])

    def test_without_the_option_there_are_no_counters(self):
        self.assertEqual(self.counters(self.sim('a16')), [])

    def test_the_list_says_how_to_read_each(self):
        sim = self.sim(f'{BUS} --distance 700')
        for number, (sensor, address) in enumerate((('a16', 1), ('a05', 2), ('hps167s', 7)), 1):
            line = sim.expect(rf' {number}  {sensor}, mode modbus, address {address}, .*: fathom (read .*)$',
                              'err')[1]
            self.ends(f'{line} --count 1', 0)

    def test_64_devices_are_one_line(self):
        sim = self.sim(' '.join(f'a16:{address}:modbus' for address in range(1, 65)),
                       '--distance 700 --counters')
        self.assertEqual(self.mm(sim, A16, '--address 64'), 700)
        self.assertEqual(self.counters(sim, 'requests'), [(0,)] * 63 + [(1,)])

    def test_one_that_sends_by_itself_beside_others_is_told(self):
        sim = self.sim('a16:1:auto hps167s:7 --distance 754')
        sim.expect('device 1 sends by itself, into what the others say', 'err')
        self.assertIn(bytes.fromhex('FF 02 F2 F3'), self.open(sim).read(12))  # FF + 02 + F2 = 1F3


class Power(Bus):
    def cut(self, sim):
        """Power off; returns at once, and when it began."""
        began = time.monotonic()
        sim.send(signal.SIGUSR1)
        sim.expect('power off for a second', 'err')
        return began

    def asks_until(self, port, request, length, is_right, baud):
        """Again and again."""
        began = time.monotonic()
        port.timeout = 0.2
        while not is_right(self.ask(port, request, length, baud)):
            self.assertLess(time.monotonic() - began, e2e.PATIENCE)
        port.timeout = e2e.PATIENCE

    def test_nothing_answers_without_power_and_what_is_kept_is_there_afterwards(self):
        sim = self.sim('a16:1:modbus hps167s:7 --distance 754 --counters')
        port = self.open(sim)
        for request, baud in ((e2e.adu(1, 6, 2, 0, 0, 5), 9600), (e2e.adu(7, 6, 0, 0x10, 0, 9), 19200)):
            self.assertEqual(self.ask(port, request, 8, baud), request)
        began = self.cut(sim)
        self.asks_until(port, e2e.adu(5, 3, 2, 0, 0, 1), 7, lambda said: said == e2e.registers(5, 5), 9600)
        self.assertGreater(time.monotonic() - began, 1)
        self.assertEqual(self.ask(port, e2e.adu(9, 3, 0, 8, 0, 4), 13, 19200)[:5], bytes((9, 3, 8, 2, 0xF2)))
        self.assertEqual(self.counters(sim, 'address', 'writes', 'flash_writes'), [(5, 1, 1), (9, 1, 1)])

    def test_an_a05_is_automatic_again_after_it(self):
        sim = self.sim('a05 --distance 700 --counters')
        self.assertEqual(self.open(sim).read(10)[0], 0xFF)
        self.mm(sim, 'a05 --mode modbus')  # ends automatic output
        self.cut(sim)
        self.assertEqual(self.mm(sim, 'a05'), 700)
        self.assertEqual(self.counters(sim, 'requests'), [(1,)])

    def test_it_goes_on_to_run_and_ends_as_always(self):
        sim = self.sim('hps167s --distance 2083')
        for _ in range(3):
            self.cut(sim)
        self.assertEqual(self.mm(sim, 'hps167s --retries 9'), 2083)
        self.assertEqual(sim.end().code, 0)

    @e2e.each(a_new_rate_acts_at_once=('', 115200),
              a_new_rate_acts_at_once_or_after_the_next_power_on=('--with baud-later', 19200))
    def rate(self, options, rate):
        sim = self.sim(f'hps167s {options}')
        port = self.open(sim)
        request = e2e.adu(1, 6, 0, 0x11, 0, 3)
        self.assertEqual(self.ask(port, request, 8), request)
        self.assertEqual(len(self.ask(port, ASK_HPS, 13, rate)), 13)
        self.cut(sim)
        self.asks_until(port, ASK_HPS, 13, lambda said: len(said) == 13, 115200)


NO_SUCH_REGISTER, WRONG_LENGTH = e2e.adu(1, 3, 3, 0, 0, 1), e2e.adu(1, 3, 0, 8, 0, 3)
BROADCAST, DATA_TYPE = e2e.adu(255, 3, 2, 0, 0, 1), e2e.adu(1, 3, 2, 7, 0, 1)
NEW_ADDRESS, NEW_ADDRESS_OF_HPS = e2e.adu(1, 6, 2, 0, 0, 5), e2e.adu(1, 6, 0, 0x10, 0, 5)
CONFIGURATION = e2e.adu(1, 3, 0, 2, 0, 4)  # termination, output; warm-up, 180 ms in 32 bits, baud code
MEASURES = e2e.registers(1, 754, 0xDCB2, 0x0701, 0)
WARM = 'hps167s --with warm-up=255'  # s: longer than anything here takes


class With(Case):
    """What the datasheets leave open, byte for byte; without the option first where that differs."""

    @e2e.each(
        refusals_of_an_a16=(NO_SUCH_REGISTER, ('a16::modbus', b''),
                            ('a16::modbus --with exceptions', e2e.adu(1, 0x83, 2))),
        answers_to_ff=(BROADCAST, ('a05:9:modbus', b''),
                       ('a05:9:modbus --with broadcast', e2e.registers(9, 9))),
        real_time_output_of_an_a16=(DATA_TYPE, ('a16::modbus', e2e.registers(1, 0)),
                                    ('a16::modbus --with real-time', e2e.registers(1, 1))),
        a_new_address_is_acknowledged_by_the_old_or_the_new=(
            NEW_ADDRESS, ('a16::modbus', NEW_ADDRESS), ('a05::modbus', NEW_ADDRESS),
            ('a16::modbus --with new-address', e2e.adu(5, 6, 2, 0, 0, 5)),
            ('a05::modbus --with new-address', e2e.adu(5, 6, 2, 0, 0, 5))),
        a_new_address_of_an_hps167s_is_acknowledged_by_the_old_or_the_new=(
            NEW_ADDRESS_OF_HPS, ('hps167s', NEW_ADDRESS_OF_HPS),
            ('hps167s --with new-address', e2e.adu(5, 6, 0, 0x10, 0, 5))),
        the_warm_up_of_an_hps167s=(ASK_HPS, ('hps167s', MEASURES), (WARM, b''),
                                   (f'{WARM} --with warm-up-04', e2e.adu(1, 0x83, 4)),
                                   (f'{WARM} --with warm-up-ff', e2e.registers(1, 0xFFFF, 0, 0xFF, 0xFFFF))),
        what_the_configuration_says=(
            CONFIGURATION, ('hps167s', e2e.registers(1, 0xFFFF, 0, 0, 0xB401)),
            ('hps167s --with output-off', e2e.registers(1, 0xFF00, 0, 0, 0xB401)),
            ('hps167s --with termination-off --with warm-up=7', e2e.registers(1, 0x00FF, 0x0700, 0, 0xB401))),
        unasked_measurements=(b'', ('hps167s', b''), ('hps167s --with unasked=100', MEASURES)),
        a_wrong_length_is_refused_by_02_or_03=(WRONG_LENGTH, ('hps167s', e2e.adu(1, 0x83, 2)),
                                               ('hps167s --with count-03', e2e.adu(1, 0x83, 3))))
    def said(self, request, *rows):
        for device, answer in rows:
            port = self.open(self.sim(f'{device} --distance 754'))
            if not answer:
                port.timeout = 0.5  # far more than the sensors need
            self.assertEqual(self.ask(port, request, len(answer) or 1), answer, device)

    @e2e.each(an_offset_replaces=('', 764), an_offset_replaces_or_adds=('--with offset-adds', 774))
    def offset(self, options, distance):
        port = self.open(self.sim(f'hps167s --distance 754 {options}'))
        for _ in range(2):
            self.ask(port, e2e.adu(1, 6, 0, 0x14, 0, 10), 8)
        self.assertEqual(self.ask(port, ASK_HPS, 13)[3:5], distance.to_bytes(2, 'big'))

    def test_for_all_means_those_that_can_and_n_means_one(self):
        port = self.open(self.sim(f'{BUS} --with exceptions --with 3@count-03'))
        self.assertEqual(self.ask(port, NO_SUCH_REGISTER, 5, 9600), e2e.adu(1, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(2, 3, 3, 0, 0, 1), 5, 9600), e2e.adu(2, 0x83, 2))
        self.assertEqual(self.ask(port, e2e.adu(7, 3, 0, 8, 0, 3), 5, 19200), e2e.adu(7, 0x83, 3))


if __name__ == '__main__':
    e2e.main()
