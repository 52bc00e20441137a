#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""fathom get and fathom set over TCP, with Modbus servers that others wrote in the place of an A16."""
import interop

FACTORY = (1, 0, 0, 0, 0, 1, 1000,
           0)  # 0x0200..0x0207: address 1, polarity 1, threshold 1 m, processed (A16 6)
NAME = 'switch-threshold'


class Servers:
    def test_a_setting_is_set_and_read_back(self):
        port = self.served((9600, 'none'), 1, 0x0200, FACTORY)
        self.assertRegex(self.ends(f'get a16 --port {port} {NAME}', 0).out, rf'{NAME} +1000')
        self.assertRegex(self.ends(f'set a16 --port {port} {NAME} 1200', 0).out, r'is 1200 mm \(was 1000\)')
        self.assertRegex(self.ends(f'get a16 --port {port} {NAME}', 0).out, rf'{NAME} +1200')

    def test_no_line_settings_are_told_and_none_are_changed(self):
        port = self.served((9600, 'none'), 1, 0x0200, FACTORY)
        self.assertIn('asked at address 1, Modbus TCP', self.ends(f'get a16 --port {port} {NAME}', 0).out)
        # Its four registers of #2: termination and measuring on, warm-up 5 s, reconnect time 180 ms, 19200
        # baud.
        port = self.served((19200, 'even'), 1, 0x0002, (0xFFFF, 0x0500, 0x0000, 0xB401))
        self.ends(f'set hps167s --port {port} baud 115200', 1,
                  "not written: the settings of this port's line cannot be changed")

    def test_no_server_there_is_exit_status_1(self):
        self.ends(f'set a16 --port tcp:127.0.0.1:1 {NAME} 1200', 1,
                  'tcp:127.0.0.1:1: Connection refused: nothing serves this port', out='')


class Pymodbus(interop.Tcp, interop.PymodbusServer, Servers, interop.Case):
    pass


class Libmodbus(interop.Tcp, interop.LibmodbusServer, Servers, interop.Case):
    pass


if __name__ == '__main__':
    interop.main()
