# SPDX-License-Identifier: MIT
"""The modules of the tool and the way of the data through them: drawn, but each module is a folder of the tool, and the
picture has each module."""
import os

import svg
from events import demand

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
TOOL = os.path.join(ROOT, 'examples', 'fathom')
# module: (left, top, colors, what it does in three lines)
WIDTH, HEIGHT = 200, 92
LEFT, MIDDLE, RIGHT, FAR = 48, 296, 544, 792
MODULES = {
    'cli': (LEFT, 88, svg.VIOLET, ('one table of options and keys:', 'parser, help, man page,', 'completion, site.yaml')),
    'commands': (MIDDLE, 88, svg.GREY, ('one file or folder for each', 'command; no logic that', 'two commands need')),
    'device': (RIGHT, 88, svg.GREEN, ('asks one sensor by sensors/;', 'changes a setting, confirms', 'it; all settings as a file')),
    'ports': (LEFT, 276, svg.RED, ('serial, TCP and GPIO as one', 'kind of port; sleeps, and finds', 'an unplugged adapter again')),
    'sensors': (MIDDLE, 276, svg.BLUE, ('all that differs between', 'sensors: modes, settings,', 'frames, how scan finds them')),
    'reading': (RIGHT, 276, svg.GREEN, ('the loop: asks all sensors,', 'median, level, alarm; each', 'failure is a reading too')),
    'output': (FAR, 220, svg.AMBER, ('text, CSV and JSON from one', 'table of fields; files,', 'progress')),
    'mqtt': (FAR, 332, svg.AMBER, ('topics, a queue, the broker,', 'discovery')),
    'diagnosis': (RIGHT, 464, svg.BLUE, ('counters; from the evidence', 'of the whole run to a cause', 'and what to try')),
}


def check():
    for module in MODULES:
        demand(os.path.isdir(os.path.join(TOOL, module)), f'examples/fathom/{module}: the picture of the tool names it')
    folders = {os.path.relpath(here, TOOL).split(os.sep)[0] for here, _, names in os.walk(TOOL)
               if any(name.endswith('.c') for name in names)}
    demand(folders - {'.'} <= set(MODULES), f'the picture of the tool lacks a module of {sorted(folders)}')


def draw(_):
    picture = svg.Picture(1040, 640, 'fathom: the modules, and the way of the data through them', (
        'Words of the command line and of a file of a site become settings in cli; a command opens sensors with them. '
        'Bytes come from ports, become readings in sensors and results in reading, and leave by one of three sinks: '
        'output prints text, CSV or JSON, commands/watch draws, mqtt publishes. Whatever fails is explained in '
        'diagnosis.'))
    picture.head('A module is a folder. It includes those before it only: output, ports, sensors, diagnosis, reading, '
                 'device, mqtt, cli, commands')
    for name, (x, y, colors, what) in MODULES.items():
        picture.rect(x, y, WIDTH, HEIGHT, colors, 6)
        picture.text(x + 14, y + 24, name + '/', 15, colors[1], bold=True)
        picture.lines(x + 14, y + 44, what, 12, 1.35)

    def right(a, b, y, text=''):
        start, end = MODULES[a][0] + WIDTH, MODULES[b][0]
        picture.arrow([(start, y), (end, y)], svg.INK, size=8)
        if text:
            picture.text((start + end) / 2, y - 6, text, 10.5, svg.MUTED, anchor='middle')

    right('cli', 'commands', 134, 'settings')
    right('commands', 'device', 134, 'get, set')
    right('ports', 'sensors', 322, 'bytes')
    right('sensors', 'reading', 322, 'samples')
    reading, out, mqtt = MODULES['reading'], MODULES['output'], MODULES['mqtt']
    for target, at in ((out, reading[1] + 20), (mqtt, reading[1] + 66)):
        picture.arrow([(reading[0] + WIDTH, at), (target[0], at)], svg.INK, size=8)
    picture.arrow([(RIGHT + WIDTH, 356), (FAR - 18, 356), (FAR - 18, 478), (FAR, 478)], svg.INK, size=8)
    picture.rect(FAR, 446, WIDTH, 64, svg.GREY, 6)
    picture.text(FAR + 14, 470, 'commands/watch/', 13, svg.GREY[1], bold=True)
    picture.text(FAR + 14, 490, 'the screen', 12)
    picture.arrow([(MIDDLE + 60, 180), (MIDDLE + 60, 276)], svg.INK, size=8)
    picture.text(MIDDLE + 68, 262, 'scan, request', 10.5, svg.MUTED)
    picture.arrow([(MIDDLE + 160, 180), (MIDDLE + 160, 228), (RIGHT + 100, 228), (RIGHT + 100, 276)], svg.INK, size=8)
    picture.text(MIDDLE + 172, 221, 'read, watch, publish', 10.5, svg.MUTED)
    picture.arrow([(RIGHT + 40, 368), (RIGHT + 40, 464)], svg.INK, size=8)
    picture.text(RIGHT + 48, 420, 'evidence of a failure', 10.5, svg.MUTED)
    picture.lines(LEFT, 478, ('Sensors, gateways and boards are at the left end:', 'their bytes, connections and edges enter by ports/.',
                              'People and programs are at the right end:', 'stdout, a file, a terminal, a broker.'), 12,
                  color=svg.MUTED)
    picture.arrow([(LEFT, 606), (LEFT + 36, 606)], svg.INK, size=8)
    picture.text(LEFT + 44, 610, 'the data\'s way. What failed, why and what to try goes to stderr in every command, by '
                 'diagnosis/.', 11.5, svg.MUTED)
    check()
    return {'tool.svg': picture.whole()}
