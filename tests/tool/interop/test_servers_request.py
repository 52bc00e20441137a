#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom request against Modbus servers that others wrote: the requests that it makes are understood, and what they
answer is shown, over a pseudo terminal and over TCP."""
import interop
from interop import e2e

LINE = (9600, 'none')
FIRST = 0x0200


class Servers:
    def ask(self, port, line, code=0, *said):
        """The object that a request gives."""
        echo = '' if port.startswith('tcp:') else '--echo off'
        done = self.ends(f'request {line} {echo} --format json --port {port}', code, *said)
        return done.json[0]

    def registers(self, port):
        found = self.ask(port, f'1 3 {FIRST} 4')
        self.assertEqual([row['register'] for row in found['registers']], ['0x0200', '0x0201', '0x0202', '0x0203'])
        return [row['unsigned'] for row in found['registers']]

    def test_registers_are_read_and_written(self):
        port = self.served(LINE, 1, FIRST, [1, 2, 3, 0xFA24])
        self.assertEqual(self.registers(port), [1, 2, 3, 0xFA24])
        written = self.ask(port, '1 6 0x0201 0xFE01 --yes')
        # An acknowledgement is the request once more (MODBUS Application Protocol V1.1b3, 6.6).
        self.assertEqual((written['status'], written['received']), ('answered', written['sent']))
        self.assertEqual(self.registers(port), [1, 0xFE01, 3, 0xFA24])
        self.assertEqual(self.ask(port, '1 16 0x0202 -7 8 --yes')['status'], 'answered')
        self.assertEqual(self.registers(port), [1, 0xFE01, 0xFFF9, 8])

    def test_nothing_is_written_without_yes(self):
        port = self.served(LINE, 1, FIRST, [1, 2, 3, 4])
        self.ends(f'request 1 6 0x0201 9 --port {port}', 2, 'Nothing was sent', out='')
        self.assertEqual(self.registers(port), [1, 2, 3, 4])

    def test_as_many_registers_as_a_frame_holds(self):
        port = self.served(LINE, 1, 0, [0] * 125)
        values = [3 * i for i in range(123)]
        self.ask(port, f'1 16 0 {" ".join(str(value) for value in values)} --yes')
        found = self.ask(port, '1 3 0 125 --yes')['registers']  # the range has 0x0009 in it
        self.assertEqual([row['unsigned'] for row in found], [*values, 0, 0])

    def test_a_register_that_is_not_there_is_exception_02(self):
        port = self.served(LINE, 1, FIRST, [1])
        found = self.ask(port, '1 3 0x0300', 1, 'unit 1 refused: exception 02 (illegal data address)')
        self.assertEqual(found['exception'], {'code': 2, 'name': 'illegal data address'})

    def test_the_answer_to_another_function_is_shown_as_bytes(self):
        """Report server ID (6.13): how long it is, no table of the tool says."""
        port = self.served(LINE, 1, FIRST, [1])
        found = self.ask(port, '1 0x11 --yes')
        self.assertEqual(found['status'], 'answered')
        answer = bytes.fromhex(found['received'])
        self.assertEqual((answer[:2], len(answer)), (b'\1\x11', 5 + answer[2]))
        self.assertEqual(e2e.crc16(answer[:-2]), answer[-2:])


class Rtu(Servers):
    def test_another_unit_is_not_there(self):
        port = self.served(LINE, 1, FIRST, [1])
        found = self.ask(port, f'9 3 {FIRST} --timeout 300', 1, 'no response from unit 9')
        self.assertEqual((found['status'], found['heard']), ('no_response', ''))

    def test_all_units_obey_what_goes_to_unit_0(self):
        port = self.served(LINE, 1, FIRST, [1, 2, 3, 4])
        self.assertEqual(self.ask(port, '0 6 0x0203 77 --yes', 0, 'sent to all units')['status'], 'sent')
        self.assertEqual(self.registers(port), [1, 2, 3, 77])

    def test_an_acknowledgement_that_could_be_an_echo_is_told_as_that(self):
        """A pseudo terminal has no wire, and so nothing takes its time."""
        port = self.served(LINE, 1, FIRST, [1])
        done = self.ends(f'request 1 6 {FIRST} 5 --yes --timeout 500 --port {port}', 0,
                         'unit 1 acknowledged the request, unless the adapter returned it')
        self.assertIn('heard     01 06 02 00 00 05 48 71\n', done.out)  # A16 6(4), example 3


class PymodbusRtu(interop.PymodbusServer, Rtu, interop.Case):
    pass


class LibmodbusRtu(interop.LibmodbusServer, Rtu, interop.Case):
    pass


class Tcp(Servers):
    def test_a_function_that_no_server_has_is_exception_01(self):
        """Over RTU neither server knows where such a request ends, and both are silent."""
        port = self.served(LINE, 1, FIRST, [1])
        found = self.ask(port, '1 0x41 12 34 --yes', 1, 'unit 1 refused: exception 01 (illegal function)')
        self.assertEqual(found['received'], e2e.adu(1, 0xC1, 1).hex(' ').upper())


class PymodbusTcp(interop.Tcp, interop.PymodbusServer, Tcp, interop.Case):
    pass


class LibmodbusTcp(interop.Tcp, interop.LibmodbusServer, Tcp, interop.Case):
    pass


if __name__ == '__main__':
    interop.main()
