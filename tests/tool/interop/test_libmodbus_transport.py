#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Modbus transport over libmodbus, RTU and TCP, does against servers that others wrote what our own client
does."""
import interop
from interop import e2e
from test_servers_write import LINE, NUMBERS, NoMany, Servers


class Rtu:
    client = 'fathom_libmodbus_client'


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
