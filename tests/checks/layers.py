#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The layers: arrows point down only. Also: a .c for every .h of the same name, and files of a size that one
sitting reads."""
import os
import re

from common import files, main, read

# From the bottom up. A header, and the source of its name, may include what stands in the layers below, and in
# its own layer what stands before it. A new header is placed here.
LAYERS = [
    ('words', 'status hal version sample'),
    ('codecs', 'crc16 modbus_rtu dyp_frame dyp_protocol pulse_width hps167s_registers'),
    ('engines', 'line line_turns output trigger stream pulse edges debounce modbus modbus_client modbus_unit '
                'modbus_setting fair_share '
                'dyp_client'),
    ('sensors', 'sensor wait contact line_pins dyp dyp_auto dyp_modbus a16_auto a16_controlled a16_modbus a16_pwm '
                'a16_settings a16_rs232 a16_switch a05_auto a05_modbus a05_dyp a05_relay a05_relay_rule '
                'hps167s hps167s_info hps167s_settings hps167s_auto'),
    ('all', 'fathom'),
]
ORDER = [(name, layer) for layer, names in LAYERS for name in names.split()]
RANK = {name: rank for rank, (name, _) in enumerate(ORDER)}
STANDARD = {'stdbool.h', 'stddef.h', 'stdint.h'}
HEADER_ONLY = {'status', 'hal', 'version', 'sample', 'fathom'}
SOURCE_ONLY = {'crc16_small': 'crc16', 'status_name': 'status',
               'line_request': 'line', 'line_listening': 'line', 'line_response': 'line', 'line_send': 'line', 'line_marks': 'line', 'line_find_echo': 'line',
               'line_count': 'line', 'modbus_client_zero': 'modbus_client'}  # the other source for a header
INSIDE = {'src/line_inside.h': {'line', 'line_listening', 'line_request', 'line_response', 'line_send', 'line_marks', 'line_find_echo', 'line_count',
                            'line_turns'},  # what the sources of one header, or of one sensor, share
          'src/modbus_client_inside.h': {'modbus_client', 'modbus_client_zero'},
          'src/hps167s_inside.h': {'hps167s', 'hps167s_info', 'hps167s_settings', 'hps167s_auto'},
          'src/common.h': {'line_inside'} | {name for layer, names in LAYERS if layer not in ('words', 'codecs')
                                     for name in names.split()}}

MAX_LINES = 400
LONGER = {}  # path: lines, with the reason beside it

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)


def check_includes(path, name, text):
    for bracket, target in INCLUDE.findall(text):
        if bracket == '<':
            if target not in STANDARD:
                yield f'{path}: includes <{target}>; only {", ".join(sorted(STANDARD))} are there everywhere'
            continue
        if os.path.splitext(os.path.basename(path))[0] in INSIDE.get(f'src/{target}', ()):
            continue
        if not target.startswith('fathom/') or target[7:-2] not in RANK:
            yield f'{path}: includes "{target}", which is no public header of the library'
            continue
        other = target[7:-2]
        if RANK[other] > RANK[name]:
            yield (f'{path}: an arrow that points up: {name} ({ORDER[RANK[name]][1]}) includes {other} '
                   f'({ORDER[RANK[other]][1]})')
        elif other == name and path.endswith('.h'):
            yield f'{path}: includes itself'


def check(root, only):
    problems = []
    headers = {os.path.basename(path)[:-2]: path for path in files(root, 'include', ends='.h')}
    sources = {os.path.basename(path)[:-2]: path for path in files(root, 'src') if path not in INSIDE}
    for name, path in headers.items():
        if path != f'include/fathom/{name}.h':
            problems.append(f'{path}: public headers stand in include/fathom/')
        if name not in RANK:
            problems.append(f'{path}: in no layer; place it in the table of tests/checks/layers.py')
        if (name in sources) == (name in HEADER_ONLY):
            problems.append(f'{path}: either src/{name}.c or a place in HEADER_ONLY')
    for name, path in sources.items():
        if path != f'src/{name}.c':
            problems.append(f'{path}: src/ holds C files and nothing else')
        elif name not in headers and name not in SOURCE_ONLY:
            problems.append(f'{path}: there is no include/fathom/{name}.h')
    for name in RANK:
        if name not in headers:
            problems.append(f'include/fathom/{name}.h: in the table of layers, but it does not exist')
    for name, path in [*headers.items(), *sources.items()]:
        text = read(root, path)
        name = SOURCE_ONLY.get(name, name)
        if name in RANK:
            problems += check_includes(path, name, text)
        lines = text.count('\n')
        if path in sources.values() and name in headers and INCLUDE.findall(text)[:1] != [('"', f'fathom/{name}.h')]:
            problems.append(f'{path}: its own header comes first, which proves that it is complete')
        if lines > LONGER.get(path, MAX_LINES):
            problems.append(f'{path}: {lines} lines, more than {MAX_LINES}: is there a second subject in it?')
    return problems


FAULTS = [
    ('include/fathom/crc16.h', '#include <stdint.h>', '#include <stdint.h>\n#include "fathom/line.h"',
     'an arrow that points up'),
    ('src/line.c', '#include "fathom/line.h"', '#include "fathom/line.h"\n#include "fathom/a16_modbus.h"',
     'an arrow that points up'),
    ('src/crc16_small.c', '#include "fathom/crc16.h"', '#include "fathom/crc16.h"\n#include "fathom/line.h"',
     'an arrow that points up'),
    ('src/line.c', None, '#include "fathom_posix.h"\n', 'no public header'),
    ('src/line.c', None, '#include "../port/posix/fathom_posix.h"\n', 'no public header'),
    ('src/line.c', None, '# include <string.h>\n', 'only stdbool.h'),
    ('include/fathom/line.h', None, '#include <avr/io.h>\n', 'only stdbool.h'),
    ('include/fathom/lidar.h', None, '/* new */\n', 'in no layer'),
    ('include/fathom/lidar.h', None, '/* new */\n', 'either src/lidar.c'),
    ('src/lidar.c', None, '/* new */\n', 'there is no include/fathom/lidar.h'),
    ('src/stream.c', None, '#include "line_inside.h"\n', 'no public header'),
    ('src/status.c', None, '#include "fathom/status.h"\n', 'HEADER_ONLY'),
    ('src/private.h', None, '/* new */\n', 'C files and nothing else'),
    ('include/secret.h', None, '/* new */\n', 'stand in include/fathom'),
    ('src/line.c', '#include "fathom/line.h"', '#include "fathom/status.h"', 'its own header comes first'),
    ('src/stream.c', None, '\n' * MAX_LINES, 'lines, more than'),
]

if __name__ == '__main__':
    main(check, FAULTS)
