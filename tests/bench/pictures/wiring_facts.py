# SPDX-License-Identifier: MIT
"""What is wired to what, and why: the levels are the datasheets', with the section behind each; what these leave open is
said to be open."""
from collections import namedtuple

Picture = namedtuple('Picture', 'name title subtitle description panels notes')
Panel = namedtuple('Panel', 'title sensor board rows block remarks')
# A wire from sensor to board; way: '>' the sensor drives, '<' the board does, '-' neither. board_way: behind a block
Row = namedtuple('Row', 'sensor board kind way board_way', defaults=('signal', '-', None))
# Between the two, over `rows` rows from `first` on; pins: (left, right) of each, None: not connected
Block = namedtuple('Block', 'name first rows pins dashed', defaults=(False,))

BOARDS = ('3.3 V board', '5 V board', 'USB adapter')
GROUND = Row('GND', 'GND', 'ground')
NO_SUPPLY = ('Supply, and the pins that are missing here: in the module\'s own papers. The text of its interface has '
             'neither.')
SWAP = 'Nothing is heard at all? Swap A and B first: makers do not agree on the letters. Ground goes along with the pair.'


def described(what, panels):
    return what + ' ' + ' '.join(f'{panel.title}: {" ".join(panel.remarks)}' for panel in panels)


def picture(name, title, subtitle, what, panels, notes):
    return Picture(name, title, subtitle, described(what, panels), panels, notes)


# ---- A16, logic level ----

A16_LEVELS = ('Levels: high is 3 V at the outputs, and at most 5 V may be put on the inputs (A16 1(1), 2(1), 3(1), 4(1)). '
              'High for an ATmega328P at 5 V is 3.0 V and more (0.6 VCC, by its datasheet); for 74HCT inputs 2.0 V and '
              'more.')
BUFFER = Block('buffer\n74HCT, 5 V', 0, 1, [('A', 'Y')])
DIRECT_3V3 = 'No level shifter: 3 V is high for an input of 3.3 V, and RX stands 5 V.'
BUFFER_5V = ('A buffer with TTL inputs in TX: 3 V is where high begins at 5 V, with no margin. Where the input\'s threshold '
             'is well below 3 V it goes direct. RX stands 5 V.')


def a16_logic(trigger, capture, remarks, adapter):
    rows = [Row('pin 4 TX', capture, 'signal', '>'), Row('pin 3 RX', trigger, 'signal', '<'), GROUND]
    return [Panel(BOARDS[0], 'A16', 'board', rows, None, [DIRECT_3V3, *remarks]),
            Panel(BOARDS[1], 'A16', 'board', rows, BUFFER, [BUFFER_5V, *remarks]), adapter]


def a16_usb(remarks):
    rows = [Row('pin 4 TX', 'RXD', 'signal', '>'), Row('pin 3 RX', 'TXD', 'signal', '<'), GROUND]
    return Panel(BOARDS[2], 'A16', 'USB to\nUART 3.3 V', rows, None, [
        'An adapter with logic levels of 3.3 V. Not one for RS-232: its levels are more than the pins stand.', *remarks])


A16 = [
    picture('a16_uart', 'A16, UART: automatic or controlled', '9600 8N1, logic level. Pin 4 sends; pin 3 selects or triggers',
            'Pin 3, RX, is driven by the board, pin 4, TX, by the module.',
            a16_logic('TX or pin', 'RX', [], a16_usb(['TXD selects or triggers by a break.'])),
            ['Automatic: pin 3 high or open gives processed values, low real-time ones (A16 2(2)); it may stay open. '
             'Controlled: each falling edge at pin 3 brings one frame (A16 3(2)). A pin does either, and so does TX of the '
             'UART by a break.', A16_LEVELS, NO_SUPPLY]),
    picture('a16_pwm', 'A16, PWM: a pulse as long as the time of flight', 'A falling edge at pin 3, then one high pulse at pin 4',
            'Pin 3, RX, is the trigger, pin 4, TX, the pulse.',
            a16_logic('output', 'capture', ['Capture: a timer\'s input, or a pin with an interrupt on both edges.'],
                      Panel(BOARDS[2], '', '', [], None, [
                          'Not with a USB adapter: it has no input that tells how long a pulse was. Take a board.'])),
            ['A pulse is 3 to 94 ms long, and begins about 110 ms after the edge (A16 1(3)); about 94 ms is no target; not '
             'more often than every 220 ms (A16 1(2)).', A16_LEVELS, NO_SUPPLY]),
    picture('a16_switch', 'A16, switch: near or far, as a level', 'Pin 4 is high when something is nearer than the threshold',
            'Pin 4, TX, is the level; both pins are a UART for settings.',
            a16_logic('TX', 'input, RX', ['Pin 4 drives no load (A16 4(2)): an input and nothing else. A weak pull makes a '
                                          'cut wire read as the harmless level.'],
                      a16_usb(['For the settings only: an adapter does not show the level.'])),
            ['Threshold and polarity are set by Modbus on the same two pins, registers 0x0205 and 0x0206 (A16 4(1), 6(3)); '
             'without that pin 3 may stay open. From the factory: 1 m, and high is near (A16 4(2)).', A16_LEVELS,
             NO_SUPPLY]),
]

# ---- RS-232 ----

RS232_ROWS = [Row('pin 3 RX', 'TX', 'signal', '<'), Row('pin 4 TX', 'RX', 'signal', '>'), GROUND]


def rs232(chip):
    return Block(chip, 0, 2, [('TOUT', 'TIN'), ('RIN', 'ROUT')])


RS232_NEEDED = 'A converter is needed: RS-232 levels of \u00b15 V and more destroy an input of a board, and are upside down.'
A16 += [
    picture('a16_rs232', 'A16, RS-232', '9600 8N1. Automatic output, until the first Modbus command',
            'Pin 3 is RX and pin 4 is TX, both at RS-232 levels.',
            [Panel(BOARDS[0], 'A16', 'board', RS232_ROWS, rs232('RS-232\nMAX3232, 3.3 V'), [RS232_NEEDED]),
             Panel(BOARDS[1], 'A16', 'board', RS232_ROWS, rs232('RS-232\nMAX232, 5 V'), [RS232_NEEDED]),
             Panel(BOARDS[2], 'A16', 'USB to\nRS-232', [Row('pin 3 RX', 'TXD, 3', 'signal', '<'),
                                                        Row('pin 4 TX', 'RXD, 2', 'signal', '>'),
                                                        Row('GND', 'GND, 5', 'ground')], None,
                   ['Direct, with an adapter that has RS-232 levels. Its numbers are those of a plug with nine pins.'])],
            ['Pin 3 is RS232-RX and pin 4 RS232-TX (A16 5(1)). This is another module than the one with logic levels: the '
             'interface is chosen when it is ordered.', NO_SUPPLY]),
]

# ---- RS-485 ----


def transceiver(name, swapped):
    return Block(name, 0, 3, [('B', 'DI'), ('A', 'RO'), (None, 'DE, /RE')] if swapped else
                 [('A', 'RO'), ('B', 'DI'), (None, 'DE, /RE')])


def rs485(sensor, first, second, rest, swapped, remarks=((), (), ())):
    """first, second: (pin, kind of wire); swapped: the first is B."""
    (pin, kind), (other, other_kind) = first, second
    ways = ('<', '>') if swapped else ('>', '<')
    names = ('TX', 'RX') if swapped else ('RX', 'TX')
    rows = [Row(pin, names[0], kind, '-', ways[0]), Row(other, names[1], other_kind, '-', ways[1]),
            Row(None, 'a pin', 'signal', '-', '<'), *rest]
    letters = ('B', 'A') if swapped else ('A', 'B')
    usb = [Row(pin, letters[0], kind), Row(other, letters[1], other_kind), *rest]
    drive = 'The port drives DE and /RE together; a resistor to ground keeps them low until the program runs.'
    return [Panel(BOARDS[0], sensor, 'board', rows, transceiver('transceiver\nMAX3485, 3.3 V', swapped),
                  ['A transceiver for 3.3 V, which the board supplies.', drive, *remarks[0]]),
            Panel(BOARDS[1], sensor, 'board', rows, transceiver('transceiver\nMAX485, 5 V', swapped),
                  ['A transceiver for 5 V, which the board supplies.', drive, *remarks[1]]),
            Panel(BOARDS[2], sensor, 'USB to\nRS-485', usb, None,
                  ['Direct, with an adapter that has RS-485. It switches its driver by itself; some hand back what they '
                   'send, which the library can find out.', *remarks[2]])]


A16 += [
    picture('a16_rs485', 'A16, RS-485', '9600 8N1, Modbus RTU, address 1', 'Pin 3 is B, pin 4 is A.',
            rs485('A16', ('pin 3 B', 'signal'), ('pin 4 A', 'signal'), [GROUND], True),
            ['Pin 3 is the inverting wire, B, and pin 4 the other, A (A16 5(1)). A terminating resistor is not mentioned: '
             'on a long pair 120 ohms at either end.', SWAP, NO_SUPPLY]),
]

# ---- A05 ----

A05_ROWS = [Row('TX', 'RX', 'signal', '>'), Row('RX', 'TX', 'signal', '<'), GROUND]
A05 = [
    picture('a05_uart', 'A05, UART', '9600 8N1. Automatic output, until the first Modbus command',
            'RX is driven by the board, TX by the module.',
            [Panel(BOARDS[0], 'A05', 'board', A05_ROWS, Block('level shifter\nif needed', 0, 1, [('5 V', '3.3 V')], True),
                   ['The text says TTL level, and no voltage. Measure TX at rest: over 3.3 V it needs a level shifter, else '
                    'it goes direct. 3.3 V at RX is high by TTL levels.']),
             Panel(BOARDS[1], 'A05', 'board', A05_ROWS, Block('level shifter\nif needed', 0, 2,
                                                              [('3 V', '5 V'), ('3 V', '5 V')], True),
                   ['Measure TX at rest: at 3 V both wires need a level shifter, since it is not said that RX stands 5 V; '
                    'at 5 V they go direct.']),
             Panel(BOARDS[2], 'A05', 'USB to\nUART 3.3 V', [Row('TX', 'RXD', 'signal', '>'),
                                                            Row('RX', 'TXD', 'signal', '<'), GROUND], None,
                   ['An adapter with logic levels of 3.3 V. Where TX rests at 5 V, one whose RXD stands that. Not one for '
                    'RS-232.'])],
            ['RX may stay open: processed values. Low in the first second after power-on: real-time ones (A05 1(1)); a pin '
             'does that, or TX by a break. Modbus needs both wires, and ends automatic output until power-off.', NO_SUPPLY]),
    picture('a05_rs485', 'A05, RS-485', '9600 8N1, Modbus RTU or the DYP protocol (55 AA), address 1', 'A to A, B to B.',
            rs485('A05', ('A', 'signal'), ('B', 'signal'), [GROUND], False),
            ['Half duplex (A05 2(1)). With several A05 on a pair use Modbus: of the DYP protocol the command that sets an '
             'address has no old address in it, and all obey (A05 2(3)5).', 'A terminating resistor is not mentioned: on a '
             'long pair 120 ohms at either end.', SWAP, NO_SUPPLY]),
    picture('a05_relay', 'A05, relay: near or far, as a contact', 'The contact closes when any probe sees something nearer than '
            'the threshold', 'The contact goes to ground and to an input with a pull-up.',
            [Panel(name, 'A05', 'board', [Row('NO', 'input', 'signal', '>'), Row('COM', 'GND', 'ground')], None,
                   [f'No level shifter: a contact has no level of its own. The pull-up, 10 kilo-ohms to {volts}, or the '
                    'board\'s own, makes it: low is near.']) for name, volts in zip(BOARDS, ('3.3 V', '5 V'))] +
            [Panel(BOARDS[2], '', '', [], None, ['Not with a USB adapter: it has no input that a program is told of. Take a '
                                                 'board.'])],
            ['NO, normally open, conducts when something is near; NC, normally closed, when nothing is (A05 4(1)). Each state '
             'lasts 1 s or more. A module without power looks like "nothing near" at either contact. 1 m from the factory, '
             'taught by a button on the module (A05 4(2)).',
             'What the contact may switch is not in the text: an input of a board is little load. ' + NO_SUPPLY]),
]

# ---- HPS-167S ----

HPS = [
    picture('hps167s', 'HPS-167S, RS-485', '19200 8E1, Modbus RTU, address 1', 'White is A, green B, black ground, red supply.',
            rs485('HPS-167S', ('white A', 'white'), ('green B', 'green'),
                  [Row('black', 'GND', 'black'), Row('red VDD', '5 V', 'red')], False,
                  (['Red to 5 V or more, not to 3.3 V.'],
                   ['560 ohms from A to 5 V and from B to ground: else a MAX485 may hear noise while nothing drives the pair.'],
                   ['5 V of USB will do: 1.4 W are 280 mA.'])),
            ['Wires: HPS-167S table 2. Supply: 5 to 15 V, at most 1.4 W, 0.1 W at rest (table 1).',
             'Its terminating resistor is on from the factory, in every unit (command #11): switch it off in all but the last '
             'one on a pair. It acts from the next power-on.', SWAP]),
]

PICTURES = A16 + A05 + HPS
