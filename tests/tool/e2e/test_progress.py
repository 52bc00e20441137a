#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The line on a terminal that shows what a command waits for, and that there is none in a pipe. (Of scan: test_scan.py.)"""
import os
import pty
import re

import e2e

MEASURING = 'calibrate hps167s --known 2000 --dry-run --samples 150'
SETTINGS = 'save a16:1 --timeout 1000'


class Progress(e2e.Case):
    @e2e.each(save=(SETTINGS, b'reading the settings'), calibrate=(MEASURING, b'measuring'))
    def shown(self, line, doing):
        port = self.device() if 'a16' in line else self.sim('hps167s --distance 2015').port
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        program = self.fathom(f'{line} --port {port}', stderr=slave)
        os.close(slave)
        said = b''
        while e2e.is_ready(master, e2e.PATIENCE):
            try:
                said += os.read(master, 4096)
            except OSError:  # the last writer has gone
                break
        done = program.finish()
        self.assertNotIn('\r', done.out)
        seconds = [int(number) for number in re.findall(rb'\r' + doing + rb', (\d+) s\x1b\[K', said)]
        self.assertEqual((seconds[0], seconds), (2, sorted(seconds)))
        # the line is removed before anything else is printed
        self.assertRegex(said, rb' s\x1b\[K\r\x1b\[K(fathom: |$)')

    @e2e.each(save_in_a_pipe=(SETTINGS,), calibrate_in_a_pipe=(MEASURING,))
    def piped(self, line):
        port = self.device() if 'a16' in line else self.sim('hps167s --distance 2015').port
        self.assertNotIn('\r', self.run_fathom(f'{line} --port {port}').err)


if __name__ == '__main__':
    e2e.main()
