#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Modbus seam over libmodbus, RTU and TCP, does against servers that others wrote what our own client does."""
import interop
from test_servers_write import Servers


class PymodbusRtu(interop.PymodbusServer, Servers, interop.Case):
    client = 'fathom_libmodbus_client'
    others = ('read:0:1', 'write:0:2', 'many:0:2')


class LibmodbusRtu(interop.LibmodbusServer, Servers, interop.Case):
    client = 'fathom_libmodbus_client'
    others = ('read:0:1', 'write:0:2')  # see test_servers_write.py


class Units(interop.LibmodbusServer, interop.Case):
    client = 'fathom_libmodbus_client'

    def test_units_that_libmodbus_has_not_are_unsupported_and_the_others_are_asked(self):
        client = self.served((19200, 'even'), 247, 0, [5])
        outcomes = self.fathom_client(client, (19200, 'even'), *(f'unit:{unit}' for unit in (248,)), 'read:0:1',
                                      'unit:255', 'write:0:1', 'unit:247', 'read:0:1')
        self.assertEqual(outcomes, ['not sent, status -12', 'not sent, status -12', '0005'])


class PymodbusTcp(interop.Tcp, interop.PymodbusServer, Servers, interop.Case):
    others = ('read:0:1', 'write:0:2', 'many:0:2')

    def test_units_that_libmodbus_has_not_are_unsupported_but_255_is_the_server(self):
        self.assertEqual(self.run_steps([5], 'unit:248', 'read:0:1', 'unit:254', 'read:0:1', 'unit:255', 'read:0:1',
                                        unit=255), ['not sent, status -12'] * 2 + ['0005'])


class LibmodbusTcp(interop.Tcp, interop.LibmodbusServer, Servers, interop.Case):
    def test_another_unit_is_not_there_and_the_right_one_is(self):
        """Over TCP libmodbus answers for every unit."""
        self.assertEqual(self.run_steps([1], 'unit:7', 'read:0:1', 'unit:8', 'read:0:1', unit=7), ['0001', '0001'])

    def test_every_exception_has_its_number_but_a_gateways_are_no_answer(self):
        numbers = (1, 2, 3, 4, 5, 6, 7, 8, 10, 11)
        for function in ('read:%d:1', 'write:%d:9', 'many:%d:9'):
            outcomes = self.run_steps(['1', *(f'!{number}' for number in numbers)], 'read:0:1',
                                      *(function % at for at in range(1, 11)), 'read:0:1', seconds=0.2)
            self.assertEqual(outcomes, ['0001', *(f'exception {number}' for number in numbers[:-2]),
                                        *['no answer'] * 2, '0001'], function)


if __name__ == '__main__':
    interop.main()
