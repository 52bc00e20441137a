# SPDX-License-Identifier: MIT
"""What run.py has to know of port/avr and of simavr."""
import os

NAME = 'avr'
PROGRAMS = ('cmake', 'avr-gcc', 'avr-objdump', 'avr-nm')
OBJDUMP, NM = 'avr-objdump', 'avr-nm'
A_PROCESS = 1  # scenario

# How far: 1 each event alone, 2 two together as well, 3 all pairs of boundaries as well. Quick has all others alone,
# the full form has them together.
QUICK = {'now_carry': 2, 'now_pending': 2, 'read_one': 2, 'read_flawed_second': 2, 'read_full': 2, 'write_one': 2,
         'write_leaving': 2, 'write_last_leaving': 2, 'sent_leaving': 2, 'sent_last_leaving': 3, 'leaves_leaving': 2,
         'break_on': 2, 'pin_high': 3, 'arm_int0': 2, 'take_int0_one': 2, 'take_int0_full': 2, 'take_icp1_full': 2,
         'icp1_begin': 2, 'idle_nothing': 2}
FULL = dict.fromkeys(
    'now_carry read_empty read_one read_flawed_second read_full write_one write_leaving write_last_leaving sent '
    'sent_leaving sent_last_leaving leaves leaves_leaving leaves_last_leaving break_on break_last_leaving pin_high '
    'pin_low arm_int0 arm_int0_high arm_icp1 take_int0_high take_int0_full take_icp1_one idle'.split(), 3)

# The objects whose functions are the port's, by the ends of their names. crc16.c shares nothing with an interrupt.
OBJECTS = ('avr/clock.c.obj', 'avr/usart0.c.obj', 'avr/icp1.c.obj', 'avr/int0.c.obj', 'avr/idle.c.obj', 'avr/pin.c.obj',
           'engine/edges.c.obj')
# Functions none of whose boundaries are wanted, and why.
BEFORE = 'fathom_avr.h: interrupts are enabled after the begin functions'
INTERRUPT = 'an interrupt: nothing comes in between but at its end; its boundaries count where two events are paired'
LEFT_OUT = {
    'fathom_avr_clock_init': BEFORE, 'fathom_avr_usart0_init': BEFORE,
    'fathom_avr_output': BEFORE, 'fathom_avr_input': BEFORE,
    'fathom_edges_init': 'edges.h: to be called before the interrupt is enabled',
    'fathom_edges_capture': 'it looks at nothing that an interrupt has',
    'fathom_edges_feed': INTERRUPT,
    **{f'__vector_{number}': INTERRUPT for number in (1, 10, 12, 13, 18, 19, 20)},
}
# Instructions that no input can reach: (function, instruction): why.
UNREACHED = {}


def build(run, tree, folder):
    """The image, and what runs it. `run` raises when a command fails."""
    image = os.path.join(folder, 'image')
    if not os.path.exists(os.path.join(image, 'CMakeCache.txt')):
        run('cmake', '-S', tree, '-B', image, f'-DCMAKE_TOOLCHAIN_FILE={tree}/port/avr/toolchain.cmake',
            '-DCMAKE_BUILD_TYPE=MinSizeRel', '-DFATHOM_TESTS=ON', '-DFATHOM_EXAMPLES=OFF')
    run('cmake', '--build', image, '--parallel', '2', '--target', 'interrupts')
    return os.path.join(image, 'images', 'interrupts.elf')


def build_host(run, tree, folder):
    host = os.path.join(folder, 'host')
    if not os.path.exists(os.path.join(host, 'CMakeCache.txt')):
        run('cmake', '-S', tree, '-B', host, '-DCMAKE_BUILD_TYPE=Release', '-DFATHOM_FIRMWARE=ON')
    run('cmake', '--build', host, '--parallel', '2', '--target', 'interrupts_avr')
    return os.path.join(host, 'tests', 'firmware', 'interrupts', 'interrupts_avr')


def command(host, image, *words):
    return [host, os.path.dirname(image), *words]
