#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""examples/nrf51, a port that stands outside of Fathom: built as a project of its own, beside a copy of Fathom, and run
on QEMU's microbit. Its UART does not tell its rate, so that the far ends are at 115200 baud, QEMU's own."""
import os
import re
import select
import shutil
import subprocess
import tempfile

import qemu
from qemu import e2e

qemu.MACHINES['nrf51'] = ('qemu-system-arm', '-M', 'microbit')
EXAMPLE = os.path.join(e2e.ROOT, 'examples', 'nrf51')
FATHOM = ('CMakeLists.txt', 'include', 'src', 'port', os.path.join('examples', 'start'))
NOT_SEEN = ['clock_wrap', 'clock_us', 'write_no_gap', 'driver', 'read_silence', 'read_stamp', 'mark_parity',
            'mark_framing', 'set_break']


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f'{" ".join(command)}: exit status {done.returncode}\n{done.stdout}')


def build(project):
    """In a folder with the example and, in it, what the page names of Fathom: nothing else is in reach."""
    shutil.copytree(EXAMPLE, project)
    for name in FATHOM:
        source, target = os.path.join(e2e.ROOT, name), os.path.join(project, 'fathom', name)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        (shutil.copytree if os.path.isdir(source) else shutil.copy)(source, target)
    images = os.path.join(project, 'build')
    run('cmake', '-S', project, '-B', images,
        f'-DCMAKE_TOOLCHAIN_FILE={os.path.join(project, "toolchain.cmake")}')
    run('cmake', '--build', images, '--parallel', '2')
    run('make', '-C', project)
    os.mkdir(os.path.join(images, 'made'))
    shutil.move(os.path.join(project, 'hps167s.elf'), os.path.join(images, 'made'))
    return images


class Nrf51(qemu.Transaction, qemu.Case):
    machine = 'nrf51'
    baud = 115200
    sim_options = ('--baud', '115200')

    def check(self, port, image='hps167s'):
        """30 responses of 13 bytes are more than an index of the ring can count."""
        done = self.end_well(self.boot(image, port, traces=('nrf51_uart_write',)))
        self.assertEqual(self.readings(done.out, 'gate'), ['probe 1 2083 mm'] * 30)
        # 29.10.14 and 29.10.15: 19200 baud, and the parity bit is included.
        written = dict(re.findall(r'nrf51_uart_write addr 0x(524|56c) value 0x(\w+)', done.err))
        self.assertEqual({name: int(value, 16) for name, value in written.items()}, {'524': 0x4EA000, '56c': 0xE})

    def test_what_the_makefile_makes_reads_too(self):
        self.check(self.sim('hps167s', *self.sim_options, '--distance', '2083').port, 'made/hps167s')

    def conformance(self):
        """Runs the kit on joined wires. Returns the ended image, and (item, verdict, figure) of each item."""
        device = self.device()
        image = self.boot('conformance', device.port)
        while True:
            ready = select.select([device.master, image.pidfd], [], [], qemu.PATIENCE)[0]
            self.assertNotEqual(ready, [], 'the image does not end')
            if device.master not in ready:
                break
            device.write(os.read(device.master, 4096))
        done = image.finish(qemu.PATIENCE)
        found = re.findall(r'^(\w+): (kept|NOT KEPT|not seen), (\d+) ', done.out, re.M)
        self.assertEqual(len(found), 26, done)
        return done, found

    def test_the_conformance_kit_finds_nothing_on_joined_wires(self):
        """What QEMU's wire does not show: bytes take no time, and none has an error. A busy machine may join the wires
        later than the kit allows, but not three times."""
        for _ in range(3):
            done, found = self.conformance()
            # On a busy machine all bytes have left before the settings are changed.
            unseen = [name for name, verdict, _ in found if verdict != 'kept' and name != 'set_line_waits']
            if done.code == 0 and unseen == NOT_SEEN:
                break
        self.assertEqual((done.code, unseen), (0, NOT_SEEN), done)
        # 40 requests of 8 bytes, of which the ring has kept 128.
        self.assertIn(('read_overrun', 'kept', '192'), found)


if __name__ == '__main__':
    with tempfile.TemporaryDirectory() as work:
        qemu.IMAGES = build(os.path.join(work, 'project'))
        qemu.main()
