#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Fathom's Modbus client (fathom_client.c) writes to Modbus servers that others wrote, and reads back: on the termios
port, where it reads first, so that it knows that the line has no echo, and over libmodbus, RTU and TCP."""
import interop
from interop import e2e

LINE = (19200, 'even')
MANY = [(i * 519 + 1) & 0xFFFF for i in range(125)]  # both bytes of the registers change
NUMBERS = (1, 2, 3, 4, 5, 6, 7, 8, 10, 11)  # of the exceptions that libmodbus can send


def words(values):
    return ' '.join(f'{value:04X}' for value in values)


def text(values):
    return ','.join(str(value) for value in values)


class Servers:
    def run_steps(self, values, *steps, first=0, unit=1, seconds=interop.SOON):
        """The outcomes of the steps, on a server with these registers."""
        client = self.served(LINE, unit, first, values)
        return self.fathom_client(client, LINE, *steps, seconds=seconds)

    @e2e.each(
        one_register_is_read=(0xFFFF, [0x1234], 'read:0xFFFF:1', '1234'),
        # 125 registers are as many as a frame holds
        **{'125_registers_are_read': (0, MANY, 'read:0:125', words(MANY)),
           '123_registers_are_written': (0, [0] * 124, f'read:123:1 many:0:{text(MANY[:123])} read:0:124',
                                         '0000', 'done', words([*MANY[:123], 0]))},
        one_register_is_written=(0x0200, [1, 2, 3], 'read:0x0200:3 write:0x0201:0xFE01 read:0x0200:3',
                                 '0001 0002 0003', 'done', '0001 FE01 0003'),
        # As the reconnect time of an HPS-167S: 180 ms, 0x000000B4 (HPS-167S #15).
        two_registers_are_written_and_their_neighbours_are_not=(
            0x1F, [9] * 4, 'read:0x1F:4 many:0x20:0,180 read:0x1F:4', '0009 0009 0009 0009', 'done',
            '0009 0000 00B4 0009'),
        one_register_is_written_as_many=(0, [1, 2], 'read:0:2 many:1:0xABCD read:0:2', '0001 0002', 'done',
                                         '0001 ABCD'),
        more_than_a_frame_holds_is_not_sent=(0, [7] * 125, f'read:0:126 many:0:{text(MANY[:124])} read:0:2',
                                             'not sent, ARGUMENT', 'not sent, ARGUMENT', '0007 0007'),
        what_is_not_there_is_exception_2_for_each_function=(
            0, [1, 2], 'read:0:2 read:2:1 read:1:2 write:2:9 many:1:8,9 read:0:2', '0001 0002',
            *['exception 2'] * 4, '0001 0002'),
        what_breaks_is_exception_4_for_each_function=(
            0, ['1', '!4'], 'read:0:1 read:1:1 write:1:9 many:0:8,9 read:0:1', '0001', *['exception 4'] * 3,
            '0001'))
    def steps(self, first, values, steps, *said):
        self.assertEqual(self.run_steps(values, *steps.split(), first=first), [*said])

    def test_the_same_value_is_written_again_and_again(self):
        """Each request and each response are alike; none may be taken for another's."""
        steps = [step for value in (5, 5, 5, 6, 6, 5) for step in (f'write:0:{value}', 'read:0:1')]
        self.assertEqual(self.run_steps([1], 'read:0:1', *steps),
                         ['0001', *(said for value in (5, 5, 5, 6, 6, 5)
                                    for said in ('done', f'{value:04X}'))])

    unit_0 = 'no response'  # libmodbus' TCP server is any unit

    def test_a_read_from_unit_0_is_answered_by_that_unit_or_not_at_all(self):
        self.assertEqual(self.run_steps([1], 'unit:0', 'read:0:1', 'unit:1', 'read:0:1'), [self.unit_0, '0001'])

    others = ('read:0:1', 'write:0:2', 'many:0:2')

    def test_another_unit_is_not_there_and_the_right_one_is(self):
        outcomes = self.run_steps([1], 'unit:7', 'read:0:1', 'unit:8', *self.others, 'unit:7', 'read:0:1',
                                  unit=7,
                                  seconds=1)
        self.assertEqual(outcomes, ['0001', *['no response'] * len(self.others), '0001'])

    def test_a_write_to_all_is_obeyed_and_needs_no_response(self):
        outcomes = self.run_steps([1, 2, 3], 'unit:9', 'read:0:3', 'unit:0', 'write:0:0x0A0B', 'unit:9',
                                  'read:0:3',
                                  'unit:0', 'many:1:0x0C0D,0x0E0F', 'unit:9', 'read:0:3', unit=9, seconds=2)
        self.assertEqual(outcomes, ['0001 0002 0003', 'done', '0A0B 0002 0003', 'done', '0A0B 0C0D 0E0F'])


class NoMany:
    """What follows another unit's request is that unit's response to libmodbus, whatever it is and whenever it
    comes. So there are two, and the second is one whose response would have its length."""
    others = ('read:0:1', 'write:0:2')


class Pymodbus(interop.PymodbusServer, Servers, interop.Case):
    pass


class Libmodbus(NoMany, interop.LibmodbusServer, Servers, interop.Case):
    @e2e.each(**{f'every_exception_that_libmodbus_can_send_has_its_number_{function[:4]}': function
                 for function in ('read:%d:1', 'write:%d:9', 'many:%d:9')})
    def numbered(self, function):
        outcomes = self.run_steps(['1', *(f'!{number}' for number in NUMBERS)], 'read:0:1',
                                  *(function % at for at in range(1, 11)), 'read:0:1')
        self.assertEqual(outcomes, ['0001', *(f'exception {number}' for number in NUMBERS), '0001'])


class Rtu:
    transport = 'libmodbus'


class PymodbusRtu(Rtu, interop.PymodbusServer, Servers, interop.Case):
    pass


class LibmodbusRtu(Rtu, NoMany, interop.LibmodbusServer, Servers, interop.Case):
    pass


class Units(Rtu, interop.LibmodbusServer, interop.Case):
    def test_units_that_libmodbus_has_not_are_unsupported_and_the_others_are_asked(self):
        outcomes = self.fathom_client(self.served(LINE, 247, 0, [5]), LINE, 'unit:248', 'read:0:1',
                                      'unit:255', 'write:0:1', 'unit:247', 'read:0:1')
        self.assertEqual(outcomes, ['not sent, UNSUPPORTED', 'not sent, UNSUPPORTED', '0005'])


class PymodbusTcp(interop.Tcp, interop.PymodbusServer, Servers, interop.Case):
    def test_units_that_libmodbus_has_not_are_unsupported_but_255_is_the_server(self):
        self.assertEqual(self.run_steps([5], 'unit:248', 'read:0:1', 'unit:254', 'read:0:1', 'unit:255',
                                        'read:0:1',
                                        unit=255), ['not sent, UNSUPPORTED'] * 2 + ['0005'])


class LibmodbusTcp(interop.Tcp, interop.LibmodbusServer, Servers, interop.Case):
    unit_0 = '0001'

    def test_another_unit_is_not_there_and_the_right_one_is(self):
        """Over TCP libmodbus answers for every unit."""
        self.assertEqual(self.run_steps([1], 'unit:7', 'read:0:1', 'unit:8', 'read:0:1', unit=7),
                         ['0001', '0001'])

    @e2e.each(**{f'every_exception_has_its_number_but_a_gateways_are_no_response_{function[:4]}': function
                 for function in ('read:%d:1', 'write:%d:9', 'many:%d:9')})
    def numbered(self, function):
        outcomes = self.run_steps(['1', *(f'!{number}' for number in NUMBERS)], 'read:0:1',
                                  *(function % at for at in range(1, 11)), 'read:0:1', seconds=2)
        self.assertEqual(outcomes, ['0001', *(f'exception {number}' for number in NUMBERS[:-2]), 'no response',
                                    'no response', '0001'])


if __name__ == '__main__':
    interop.main()
