#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom read against a server that answers wrongly: byte for byte by hand, which no Modbus library does. No wrong
answer may become a reading, and the next right one does."""
import interop
from interop import e2e

SAID = {'a16': (754,), 'a05': (1000, 2000, 1953, 3562), 'hps167s': (0x0823, 0xDCB2, 0x0701, 0)}
READ = {'a16': ['754'], 'a05': ['1000', '2000', '1953', '3562'], 'hps167s': ['2083']}
REQUEST = {'a16': (1, 0, 0, 1), 'a05': (1, 6, 0, 4), 'hps167s': (0, 8, 0, 4)}  # address and count

UNFIT = 'address 1 answered something else than was asked; check that it is '
DAMAGED = 'the answer of address 1 was damaged; '
SILENT = 'no answer from address 1: '
OTHERS = SILENT + 'the line works, but it was address 2 that was heard; try --address 2'
NOBODYS = SILENT + 'the line works, but it was address 255 that was heard, which no '
NO_FRAME = SILENT + 'bytes were heard, but no Modbus frame'


def resized(answer, size, data):
    """Another byte count and other data, under a right CRC."""
    return e2e.adu(*answer[:2], size, *data)


class Raw:
    def wrong(self, make, words):
        """The first request is answered by make(right answer), the second rightly."""
        device = self.device()
        request = e2e.adu(1, 3, *REQUEST[self.sensor])
        reader = self.fathom('read', self.sensor, '--mode', 'modbus', '--port', device.path, '--count', '2',
                             '--timeout', '150', '--format', 'csv')
        right = e2e.registers(1, *SAID[self.sensor])
        self.assertEqual(device.read(8), request)
        device.write(make(right))
        self.assertEqual(device.read(8), request)
        device.write(right)
        done = reader.finish()
        self.assertEqual([row.split(',')[9] for row in done.out.splitlines()[1:]], READ[self.sensor], done)
        self.assertEqual(done.code, 1)
        self.assertIn(f'attempt 1: {words}', done.err)
        self.assertEqual(done.err.count('attempt '), 1, done.err)
        self.assertIn(f'attempts 2, failed 1, readings {len(READ[self.sensor])}\n', done.err)

    def test_more_registers_than_were_asked_for(self):
        self.wrong(lambda right: resized(right, right[2] + 2, (*right[3:-2], 2, 1)), UNFIT)

    def test_fewer_registers_than_were_asked_for(self):
        """Of one register there are no fewer: none at all is no frame."""
        words = NO_FRAME if self.sensor == 'a16' else UNFIT
        self.wrong(lambda right: resized(right, right[2] - 2, right[3:-4]), words)

    def test_the_input_registers_of_function_04(self):
        self.wrong(lambda right: e2e.adu(1, 4, *right[2:-2]), NO_FRAME)

    def test_the_acknowledgement_of_a_write(self):
        self.wrong(lambda right: e2e.adu(1, 6, *REQUEST[self.sensor]), UNFIT)

    def test_another_units_answer(self):
        self.wrong(lambda right: e2e.registers(2, *SAID[self.sensor]), OTHERS)

    def test_an_exception_to_this_request(self):
        self.wrong(lambda right: e2e.adu(1, 0x83, 3), 'address 1 refused: exception 03 (illegal data value)')

    def test_a_wrong_crc(self):
        self.wrong(lambda right: right[:-1] + bytes((right[-1] ^ 1,)), DAMAGED)


class A16(Raw, interop.Case):
    sensor = 'a16'


class A05(Raw, interop.Case):
    sensor = 'a05'


class Hps167s(Raw, interop.Case):
    sensor = 'hps167s'

    def test_an_odd_byte_count(self):
        self.wrong(lambda right: resized(right, right[2] + 1, (*right[3:-2], 0x55)), NO_FRAME)

    def test_a_byte_count_that_is_too_large_for_what_comes(self):
        """The frame is not whole when its data are over."""
        self.wrong(lambda right: resized(right, right[2] + 2, right[3:-2]), DAMAGED)

    def test_the_acknowledgement_of_a_write_of_many(self):
        self.wrong(lambda right: e2e.adu(1, 16, *REQUEST[self.sensor]), UNFIT)

    def test_another_units_exception(self):
        self.wrong(lambda right: e2e.adu(2, 0x83, 2), OTHERS)

    def test_an_exception_to_another_function(self):
        self.wrong(lambda right: e2e.adu(1, 0x86, 2), UNFIT)

    def test_an_exception_to_a_function_that_was_never_used(self):
        self.wrong(lambda right: e2e.adu(1, 0x84, 2), NO_FRAME)

    def test_a_crc_in_the_other_order(self):
        self.wrong(lambda right: right[:-2] + right[:-3:-1], DAMAGED)

    def test_an_answer_without_its_end(self):
        self.wrong(lambda right: right[:-1], DAMAGED)

    def test_an_answer_without_its_beginning(self):
        self.wrong(lambda right: right[1:], NO_FRAME)

    def test_a_broadcast_answer(self):
        """Unit 0 asks, and never answers."""
        self.wrong(lambda right: e2e.registers(0, *SAID[self.sensor]), NO_FRAME)

    def test_an_answer_to_everybody(self):
        self.wrong(lambda right: e2e.registers(255, *SAID[self.sensor]), NOBODYS)


class Echo(interop.Case):
    def test_the_request_itself_is_no_reading(self):
        for sensor, request in REQUEST.items():
            device = self.device()
            reader = self.fathom('read', sensor, '--mode', 'modbus', '--port', device.path, '--count', '1',
                                 '--timeout', '150', '--format', 'csv')
            device.write(device.read(8))
            done = reader.finish()
            self.assertEqual((done.code, done.out.count('\n')), (1, 1), done)
            self.assertIn('attempts 1, failed 1, readings 0\n', done.err)


class Right(interop.Case):
    def test_an_answer_behind_another_units_is_read(self):
        for sensor, values in SAID.items():
            device = self.device()
            reader = self.fathom('read', sensor, '--mode', 'modbus', '--port', device.path, '--count', '1',
                                 '--format', 'csv')
            device.read(8)
            device.write(e2e.registers(2, 1, 2, 3, 4))
            device.write(e2e.registers(1, *values))
            done = reader.finish()
            self.assertEqual((done.code, [row.split(',')[9] for row in done.out.splitlines()[1:]]),
                             (0, READ[sensor]), done.err)
            self.assertIn('frames that nobody asked for 1\n', done.err)

    def test_an_answer_in_pieces_is_read(self):
        device = self.device()
        reader = self.fathom('read', 'hps167s', '--port', device.path, '--count', '1', '--format', 'csv')
        device.read(8)
        for byte in e2e.registers(1, *SAID['hps167s']):
            device.write((byte,))
        done = reader.finish()
        self.assertEqual((done.code, done.out.count(',target,false,2083,2083,723.1744,1,0\n')), (0, 1), done.err)


if __name__ == '__main__':
    interop.main()
