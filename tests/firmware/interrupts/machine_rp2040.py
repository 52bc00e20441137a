# SPDX-License-Identifier: MIT
"""What run.py has to know of port/rp2040, of port/serial on the same machine, and of rp2040js."""
import os

NAME = 'rp2040'
PROGRAMS = ('cmake', 'node', 'npm', 'arm-none-eabi-gcc', 'arm-none-eabi-objdump', 'arm-none-eabi-nm')
OBJDUMP, NM = 'arm-none-eabi-objdump', 'arm-none-eabi-nm'
A_PROCESS = 8  # scenarios: starting a process takes as long as several scenarios
QUICK = {'now': 2, 'sent_leaving': 2, 'take_one': 2, 'pin_high': 2, 'idle_nothing': 2, 'serial_write_leaving': 2}
PAIRS = 'now sent level arm arm_high pin_low idle_nothing'.split()
ALONE = ('read_three read_in_part read_wraps read_silent read_no_idle read_leaving read_full read_full_whole '
         'write_one write_most write_gone write_gone_more write_no_driver line_same_rate line_stop_bits line_new '
         'line_fastest line_over_fastest line_slowest line_too_fast line_too_slow line_none line_no_parity '
         'line_no_stop idle idle_three idle_leaving idle_short idle_long idle_no_deadline '
         'serial_read_full').split()
FULL = {**dict.fromkeys(PAIRS, 3), **dict.fromkeys(ALONE, 1)}

# The objects whose functions are the port's, by the ends of their names.
OBJECTS = ('rp2040/clock.c.obj', 'rp2040/uart.c.obj', 'rp2040/uart_setup.c.obj', 'rp2040/alarm.c.obj',
           'rp2040/edges.c.obj', 'rp2040/idle.c.obj', 'rp2040/pin.c.obj', 'engine/edges.c.obj',
           'images/CMakeFiles/rp2040_interrupts.dir/interrupts_serial.c.obj')
# Functions none of whose boundaries are wanted, and why.
BEFORE = 'called before the interrupt is enabled'
INTERRUPT = 'an interrupt: its boundaries count where two events are paired'
NOTHING = 'it looks at nothing that an interrupt has'
LEFT_OUT = {
    'fathom_rp2040_clock_init': BEFORE, 'fathom_rp2040_uart_init': BEFORE, 'fathom_rp2040_uart_setup': BEFORE,
    'fathom_rp2040_idle_init': BEFORE, 'fathom_rp2040_alarm_enable': BEFORE, 'fathom_rp2040_output': BEFORE,
    'fathom_rp2040_input': BEFORE, 'fathom_edges_init': BEFORE, 'serial_begin': BEFORE,
    'fathom_rp2040_uart': NOTHING, 'fathom_edges_capture': NOTHING,
    'fathom_rp2040_uart_interrupt': INTERRUPT, 'fathom_rp2040_uart_alarm': INTERRUPT,
    'fathom_rp2040_idle_alarm': INTERRUPT, 'fathom_rp2040_edges_interrupt': INTERRUPT, 'fathom_edges_feed': INTERRUPT,
    'serial_interrupt': INTERRUPT, 'fathom_serial_count': INTERRUPT,
}
# Instructions that no input can reach: (function, instruction): why.
UNREACHED = {}


def build(run, tree, folder):
    """The image, and what runs it. `run` raises when a command fails."""
    image = os.path.join(folder, 'image')
    if not os.path.exists(os.path.join(image, 'CMakeCache.txt')):
        run('cmake', '-S', tree, '-B', image, f'-DCMAKE_TOOLCHAIN_FILE={tree}/port/rp2040/toolchain.cmake',
            '-DCMAKE_BUILD_TYPE=MinSizeRel', '-DFATHOM_TESTS=ON')
    run('cmake', '--build', image, '--parallel', '2', '--target', 'rp2040_interrupts')
    return os.path.join(image, 'images', 'rp2040_interrupts.elf')


def build_host(run, tree, folder):
    """The folder of rp2040js."""
    host = os.path.join(folder, 'host')
    if not os.path.exists(os.path.join(host, 'CMakeCache.txt')):
        run('cmake', '-S', tree, '-B', host, '-DCMAKE_BUILD_TYPE=Release', '-DFATHOM_FIRMWARE=ON')
    run('cmake', '--build', host, '--target', 'firmware_rp2040_packages')
    return os.path.join(host, 'tests', 'firmware', 'rp2040', 'packages', 'node_modules')


def command(host, image, *words):
    main = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'rp2040', 'main.js')
    return ['env', f'NODE_PATH={host}', f'FATHOM_IMAGES={os.path.dirname(image)}', 'node', main, *words]
