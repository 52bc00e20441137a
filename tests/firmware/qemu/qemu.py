# SPDX-License-Identifier: MIT
"""What the tests with QEMU share: an image is booted with programs, or the test itself, at the far ends of its UARTs,
and ends by itself with an exit status. What it says by semihosting is the program's stdout, traces are its stderr.

QEMU has no bits on its wires, and its time is the time of this machine: on a busy one the far ends answer late. So
nothing here is judged by how long it takes, and an attempt may fail for that; what must not be is a wrong reading."""
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TESTS = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(TESTS, 'tool', 'interop'))

import interop  # noqa: E402
from interop import e2e  # noqa: E402

IMAGES = os.environ.get('FATHOM_IMAGES', '')
PATIENCE = 60  # seconds; an image takes up to 5
MACHINES = {'stm32f4': ('qemu-system-arm', '-M', 'netduinoplus2'),
            'virt': ('qemu-system-riscv32', '-M', 'virt', '-bios', 'none')}
# What a slow far end may cause: no response, one that broke off, a stream that was read out of step and refused, a stale
# one.
LATE = {'NO_RESPONSE', 'CHECKSUM', 'MALFORMED', 'STALE'}

DATASHEET = ('0x0823', '0xDCB2', '0x0701', '0x0000')  # HPS-167S #5: 2083 mm, 723.1744


class Case(interop.Case):
    machine = os.path.basename(os.path.dirname(os.path.abspath(sys.argv[0])))

    def boot(self, image, *ports, traces=(), shift=None):
        """Starts an image. ports: what its UARTs are connected to, in QEMU's order; None: nothing.
        shift: simulated time, 2^shift ns an instruction, the same on every run."""
        path = os.path.join(IMAGES, image + '.elf')
        self.assertTrue(os.access(path, os.R_OK), f'{path} is not there: FATHOM_IMAGES says where it is built')
        options = ['-kernel', path, '-display', 'none', '-monitor', 'none', '-chardev', 'stdio,id=say,signal=off',
                   '-semihosting-config', 'enable=on,target=native,chardev=say']
        for number, port in enumerate(ports):
            if port is None:
                options += ['-serial', 'null']
            else:
                options += ['-chardev', f'serial,id=uart{number},path={port}', '-serial', f'chardev:uart{number}']
        for trace in traces:
            options += ['-trace', trace]
        if shift is not None:
            options += ['-serial', 'null', '-icount', f'shift={shift},sleep=off', '-rtc', 'clock=vm']
        return self.start([*MACHINES[self.machine], *options])

    def end_well(self, program):
        done = program.finish(PATIENCE)
        self.assertEqual(done.code, 0, done)
        return done

    def self_test(self, image, count, shift=5):
        """Runs an image that checks itself, in simulated time. count: of its checks, so that none can be left out."""
        done = self.boot(image, shift=shift).finish(PATIENCE)
        self.assertEqual(re.findall(r'^FAILED .*\n.*', done.out, re.M), [])
        self.assertEqual(len(re.findall(r'^ok ', done.out, re.M)), count, done.out)
        self.assertEqual(done.code, 0, done)

    def readings(self, out, name, most_errors=None):
        """What the image has told of a line, without its errors, of which there are fewer, or as many as is said."""
        told = re.findall(rf'^{name} (.*)$', out, re.M)
        errors = [words.split()[1] for words in told if words.startswith('error ')]
        self.assertLessEqual(set(errors), LATE, out)
        readings = [words for words in told if not words.startswith('error ')]
        self.assertLessEqual(len(errors), len(readings) if most_errors is None else most_errors, out)
        return readings


def alone(**images):
    """Tests of images that check themselves: what it shows=(image, checks) or (image, checks, shift)."""
    tests = {f'test_{name}': lambda self, row=row: self.self_test(*row) for name, row in images.items()}
    sys.modules['__main__'].Alone = type('Alone', (Case,), {**tests, '__module__': '__main__'})
    main()


class Transaction:
    """For a Case with check(port): an HPS-167S at 2083 mm, simulated and served by others. sim_options: of its rate."""
    serve = interop.LibmodbusServer.serve
    baud = 19200
    sim_options = ()

    def test_a_simulated_sensor_is_read(self):
        self.check(self.sim('hps167s', *self.sim_options, '--distance', '2083').port)

    def test_a_server_by_libmodbus_is_read(self):
        self.check(self.served((self.baud, 'even'), 1, 8, DATASHEET))


def main():
    e2e.main()
