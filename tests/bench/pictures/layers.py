# SPDX-License-Identifier: MIT
"""The layers, and what may include what: drawn, but each header that it names has to stand in its folder."""
import os

import svg
from events import demand

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
INCLUDE = os.path.join(ROOT, 'include', 'fathom')
# folder ('': include/fathom itself), colors, what it is, headers
LAYERS = [
    ('sensor', svg.GREEN, 'one driver for each sensor and mode',
     ['a16_auto', 'a16_pwm', 'a16_modbus', 'a05_auto', 'a05_relay', 'hps167s', 'hps167s_settings']),
    ('processing', svg.GREEN, 'what is made of readings: levels, alarms, filters',
     ['alarm', 'debounce', 'level', 'median']),
    ('engine', svg.BLUE, 'a protocol over time: state and a clock, and never a wait',
     ['line', 'modbus_client', 'stream', 'pulse', 'trigger', 'contact']),
    ('codec', svg.VIOLET, 'bytes to structs and back: pure functions; no time, no I/O, no state',
     ['crc16', 'modbus_rtu', 'pulse_width', 'hps167s_registers']),
    ('', svg.AMBER, 'the words that all share', ['status', 'sample', 'hal', 'version']),
]
LEFT, WIDTH, TOP, HEIGHT, STEP = 48, 600, 196, 70, 100
PORT, PORT_WIDTH = 740, 252
PORTS = [['posix', 'libmodbus'], ['avr', 'rp2040', 'stm32f4'], ['arduino']]
DOWN = LEFT + 546  # arrows
LAST = (len(LAYERS) - 1) * STEP  # from the top layer to the lowest one


def check():
    sorted_in = os.path.isdir(os.path.join(INCLUDE, 'codec'))
    for folder, _, _, headers in LAYERS:
        for header in headers:
            path = os.path.join(INCLUDE, folder if sorted_in else '', header + '.h')
            demand(os.path.exists(path), f'{path}: the picture of the layers names it')
    for port in [*sum(PORTS, []), 'sim']:
        demand(os.path.isdir(os.path.join(ROOT, 'port', port)), f'port/{port}: the picture of the layers names it')


def layer(picture, y, name, colors, what, headers):
    picture.rect(LEFT, y, WIDTH, HEIGHT, colors, 6)
    picture.text(LEFT + 18, y + 27, name, 15, colors[1], bold=True)
    picture.text(LEFT + 130, y + 27, what, 12)
    picture.text(LEFT + 18, y + 53, ', '.join(headers) + (', ...' if len(headers) > 4 or name == 'codec/' else ''), 11,
                 svg.MUTED, mono=True, within=WIDTH - 30)


def draw(_):
    check()
    picture = svg.Picture(1040, 722, 'The layers, and what may include what', (
        'From the top: the program; the library with sensor, processing, engine, codec and the words that all share; beside them the '
        'ports. Arrows of includes point down only. A layer includes only layers below it, and '
        'nothing in the library includes a port, which implements hal.h.'))
    picture.head('The folder is the layer. Arrows point down only, which tests/checks/layers.py holds')
    picture.rect(LEFT, 84, PORT + PORT_WIDTH - LEFT, 56, svg.GREY, 6)
    picture.text(LEFT + 18, 117, 'your program', 15, bold=True)
    picture.text(LEFT + 150, 117, 'and examples/: owns all memory, calls poll again and again; may include everything', 12)

    picture.rect(LEFT - 20, TOP - 28, WIDTH + 40, LAST + HEIGHT + 44, ('none', svg.GREY[1]), 8, dash='5 4')
    picture.text(LEFT - 6, TOP - 11, 'the library, include/ and src/: freestanding C99 with stdint, stdbool, stddef, and '
                 'nothing else', 11, svg.MUTED)
    for i, (folder, colors, what, headers) in enumerate(LAYERS):
        y = TOP + i * STEP
        layer(picture, y, folder + '/' if folder else 'words', colors, what, headers)
        if i:
            picture.arrow([(DOWN, y - STEP + HEIGHT), (DOWN, y)], svg.INK, size=8)
    picture.arrow([(DOWN, 140), (DOWN, TOP)], svg.INK, size=8)
    # a sensor may use a codec, and all use the words: past the layers between
    side = LEFT + WIDTH
    picture.arrow([(side - 24, TOP + HEIGHT), (side - 24, TOP + STEP - 13), (side + 10, TOP + STEP - 13),
                   (side + 10, TOP + LAST - STEP + 30), (side, TOP + LAST - STEP + 30)], svg.INK, size=8)

    port_top, port_height = TOP + STEP, LAST + HEIGHT - STEP
    picture.rect(PORT, port_top, PORT_WIDTH, port_height, svg.RED, 6)
    picture.text(PORT + 18, port_top + 27, 'port/', 15, svg.RED[1], bold=True)
    y = picture.lines(PORT + 18, port_top + 52, ('fills in the structs of hal.h:', 'UART, clock, pin, capture.'), 12)
    y = picture.lines(PORT + 18, y + 8, [', '.join(ports) for ports in PORTS], 11, color=svg.MUTED, mono=True)
    y = picture.lines(PORT + 18, y + 4, ('sim: simulated sensors at the', 'far end, without hardware'), 11, color=svg.MUTED)
    y = picture.lines(PORT + 18, y + 10, ('The only place for a header of', 'an OS or of a chip.'), 12)
    picture.lines(PORT + 18, y + 8, ('May include the library, which', 'never includes a port.'), 12)
    picture.arrow([(PORT + 126, 140), (PORT + 126, port_top)], svg.INK, size=8)
    words = TOP + LAST
    picture.arrow([(PORT, words + 24), (LEFT + WIDTH, words + 24)], svg.INK, size=8)
    picture.arrow([(LEFT + WIDTH, TOP + 2 * STEP + 50), (PORT, TOP + 2 * STEP + 50)], svg.RED[1], 1.5, '5 4', 8)

    y = 700
    picture.arrow([(48, y - 4), (84, y - 4)], svg.INK, size=8)
    picture.text(92, y, 'may include; a layer also what is below the next one', 11.5, svg.MUTED)
    picture.arrow([(440, y - 4), (476, y - 4)], svg.RED[1], 1.5, '5 4', 8)
    picture.text(484, y, 'calls by pointers in the structs of hal.h, and includes nothing', 11.5, svg.MUTED)
    return {'layers.svg': picture.whole()}
