#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The compilers find no warning in src/, no mutable data, no call but of the library itself and of named helpers of the
compiler, and no recursion: on this machine, a Cortex-M0+, an ATmega328P and an RV32IMAC. The portable part of port/sim
builds there too."""
import os
import re
import tempfile

from common import WARNINGS, files, main, run

# Helpers of the compiler's own library that integer code may need. None of them is libc's or does floats.
ARM_HELPERS = {'__aeabi_uidiv', '__aeabi_uidivmod', '__aeabi_idiv', '__aeabi_idivmod',
               '__gnu_thumb1_case_uqi', '__gnu_thumb1_case_sqi', '__gnu_thumb1_case_uhi',
               '__gnu_thumb1_case_shi', '__gnu_thumb1_case_si'}
AVR_HELPERS = {'__prologue_saves__', '__epilogue_restores__', '__tablejump2__', '__udivmodqi4',
               '__udivmodhi4', '__divmodhi4', '__udivmodsi4', '__divmodsi4', '__mulsi3', '__mulhi3',
               '__umulhisi3', '__mulhisi3', '__muluhisi3', '__mulshisi3', '__usmulhisi3'}
# On a desk gcc may turn a loop into one of these; where they cost, on those below, it must not.
HOST_HELPERS = {'memcpy', 'memset', 'memmove', 'memcmp'}

SECTIONS = ['-ffunction-sections', '-fdata-sections']
TARGETS = [
    # name, compiler, prefix of its tools, helpers
    ('host', ['gcc', '-O2'], '', HOST_HELPERS),
    ('Cortex-M0+', ['arm-none-eabi-gcc', '-mcpu=cortex-m0plus', '-mthumb', '-Os', *SECTIONS],
     'arm-none-eabi-', ARM_HELPERS),
    ('ATmega328P', ['avr-gcc', '-mmcu=atmega328p', '-Os', *SECTIONS], 'avr-', AVR_HELPERS),
    ('RV32IMAC', ['riscv64-unknown-elf-gcc', '-march=rv32imac', '-mabi=ilp32', '-ffreestanding', '-Os', *SECTIONS],
     'riscv64-unknown-elf-', set()),
]
# An AVR keeps const data in RAM: so many bytes, no more and no less. The CRC's, which is why an AVR has one of its own;
# the functions of a line and of a protocol; what a switch becomes; the facts of a datasheet's sensor; and the names of
# statuses.
AVR_CONST = {'src/codec/crc16.c': 512, 'src/codec/crc16_small.c': 32, 'src/engine/line_request.c': 10,
             'src/engine/line_listening.c': 10, 'src/engine/line_senders.c': 6, 'src/engine/line_masters.c': 8,
             'src/engine/modbus_client.c': 14, 'src/engine/modbus_client_zero.c': 14, 'src/engine/modbus_command.c': 6,
             'src/engine/dyp_client.c': 14, 'src/sensor/a05_auto.c': 23, 'src/sensor/a05_dyp.c': 23,
             'src/sensor/a05_modbus.c': 23, 'src/sensor/a16_auto.c': 23, 'src/sensor/a16_controlled.c': 23,
             'src/sensor/a16_modbus.c': 23, 'src/sensor/a16_pwm.c': 23, 'src/sensor/factory_line.c': 24, 'src/sensor/hps167_uart.c': 14,
             'src/status_name.c': 176, 'src/status_advice.c': 1694}
MODELS = 'src/models/'  # tables, each row of which is linked alone: of any size
AVR_ONLY = ['port/avr/crc16.c', 'port/avr/crc16_table.c']


def sections(prefix, obj, root):
    """{kind: bytes} of what would need RAM at run time, or flash for constants."""
    _, said = run([prefix + 'size', '-A', obj], root)
    total = {'.data': 0, '.bss': 0, '.rodata': 0}
    for name, size in re.findall(r'^(\.\S+)\s+(\d+)', said, re.M):
        for kind in total:
            if name == kind or name.startswith(kind + '.'):
                if not name.startswith('.data.rel.ro'):  # const, with addresses that a loader fills in
                    total[kind] += int(size)
    return total


def check_object(path, target, prefix, helpers, obj, root):
    size = sections(prefix, obj, root)
    expected = {'.data': 0, '.bss': 0}
    if target == 'ATmega328P' and not path.startswith(MODELS):
        expected['.rodata'] = AVR_CONST.get(path, 0)
    for kind, count in expected.items():
        if size[kind] != count:
            yield f'{path}: {size[kind]} bytes of {kind} on {target}, not {count}'
    _, said = run([prefix + 'nm', obj], root)
    called = re.findall(r'^\s+U (\S+)$', said, re.M)
    for name in called:
        if target == 'ATmega328P' and (path in AVR_CONST or path.startswith(MODELS)) and name == '__do_copy_data':
            continue
        if not name.startswith('fathom_') and name not in helpers and name != '_GLOBAL_OFFSET_TABLE_':
            yield f'{path}: calls {name} on {target}'
    for name in re.findall(r'^[0-9a-f]+ [A-Z] (\S+)$', said, re.M):
        if not name.startswith('fathom_') and not name.startswith('__'):
            yield f'{path}: {name} is visible to the linker without fathom_ on {target}'


def recursion(graphs):
    """Cycles in the direct calls of all sources together, as they were written (-O0)."""
    calls, where = {}, {}
    for path, text in graphs:
        def whole(title, path=path):
            return path + ':' + title.rsplit(':', 1)[1] if ':' in title else title
        for caller, callee in re.findall(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text):
            where[whole(caller)] = path
            if callee != '__indirect_call':
                calls.setdefault(whole(caller), set()).add(whole(callee))
    done, problems = set(), []

    def visit(node, trail):
        if node in trail:
            loop = (*trail[trail.index(node):], node)
            problems.append(f'{where[node]}: recursion: {" > ".join(loop)}')
        elif node not in done:
            for callee in sorted(calls.get(node, ())):
                visit(callee, (*trail, node))
            done.add(node)

    for node in sorted(calls):
        visit(node, ())
    return problems


def check(root):
    problems, graphs = [], []
    core = files(root, 'src', ends='.c')
    sim = [path for path in files(root, 'port/sim', ends='.c') if os.path.basename(path) != 'pty.c']
    with tempfile.TemporaryDirectory() as work:
        obj = os.path.join(work, 'object.o')
        for target, compiler, prefix, helpers in TARGETS:
            extra = AVR_ONLY if target == 'ATmega328P' else []
            for path in core + extra + (sim if target != 'RV32IMAC' else []):
                good, said = run([*compiler, '-std=c99', *WARNINGS, '-Iinclude', '-Iport/sim', '-c', path, '-o', obj],
                                 root)
                if not good:
                    problems.append(f'{path}: does not compile for {target}:\n{said}')
                elif path not in sim:
                    problems += check_object(path, target, prefix, helpers, obj, root)
        for path in core:
            good, _ = run(['gcc', '-O0', '-fcallgraph-info', '-std=c99', '-Iinclude', '-c', path, '-o', obj], root)
            if good:
                with open(obj[:-1] + 'ci', encoding='utf-8') as file:
                    graphs.append((path, file.read()))
    return problems + recursion(graphs)


if __name__ == '__main__':
    main(check)
