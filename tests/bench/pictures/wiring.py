# SPDX-License-Identifier: MIT
"""How each sensor is wired to a 3.3 V board, a 5 V board and a USB adapter; wiring_facts.py says what to what."""
import svg
from wiring_facts import PICTURES

PANEL, GAP, TOP = 348, 14, 84
ROW, BOX_TOP = 32, 64
SENSOR, BLOCK, BOARD = (10, 92), (146, 80), (268, 72)  # x and width in a panel
WIRES = {'signal': svg.INK, 'green': '#1c7a3c', 'red': '#b3261e', 'white': '#9aa5b1', 'black': '#111111',
         'supply': '#b3261e', 'ground': '#111111'}


def wrap(text, size, width):
    lines, line = [], ''
    for word in text.split():
        longer = f'{line} {word}'.strip()
        if svg.text_width(longer, size) > width:
            lines.append(line)
            longer = word
        line = longer
    return [*lines, line]


def wire(picture, x0, x1, y, kind, way):
    """way: '>', '<' or '-'."""
    color = WIRES[kind]
    if way == '-':
        picture.path([(x0, y), (x1, y)], color, 2.2)
    else:
        picture.arrow([(x0, y), (x1, y)] if way == '>' else [(x1, y), (x0, y)], color, 1.8)
    if kind == 'white':
        picture.path([(x0, y), (x1, y)], svg.PAPER, 0.9)


def box(picture, x, y, width, rows, name, colors, dashed=False):
    picture.rect(x, y, width, rows * ROW + 8, colors, 5, dash='4 3' if dashed else None)
    lines = name.split('\n')
    picture.lines(x + width / 2, y - 7 - 13 * (len(lines) - 1), lines, 11, 13 / 11, color=colors[1], anchor='middle',
                  bold=True)


def draw_block(picture, x, y, block):
    at, width = BLOCK
    box(picture, x + at, y + block.first * ROW, width, block.rows, block.name, svg.VIOLET, block.dashed)
    for i, (left, right) in enumerate(block.pins):
        base = y + (block.first + i) * ROW + ROW / 2 + 8
        if left:
            picture.text(x + at + 5, base, left, 10.5)
        if right:
            picture.text(x + at + width - 5, base, right, 10.5, anchor='end')


def draw_panel(picture, x, rows, panel):
    picture.rect(x, TOP, PANEL, rows, (svg.PAPER, svg.RULE), 6)
    picture.text(x + 12, TOP + 22, panel.title, 13.5, bold=True)
    y = TOP + BOX_TOP
    if panel.rows:
        for (at, width), name, colors in ((SENSOR, panel.sensor, svg.GREEN), (BOARD, panel.board, svg.BLUE)):
            box(picture, x + at, y, width, len(panel.rows), name, colors)
    for i, row in enumerate(panel.rows):
        middle = y + i * ROW + ROW / 2 + 4
        block = panel.block
        in_block = block is not None and block.first <= i < block.first + block.rows
        left, right = sum(SENSOR), BOARD[0]
        if row.sensor:
            picture.text(x + left - 6, middle + 4, row.sensor, 11, anchor='end', within=SENSOR[1] - 8)
        if row.board:
            picture.text(x + right + 6, middle + 4, row.board, 11, within=BOARD[1] - 8)
        if not in_block:
            wire(picture, x + left, x + right, middle, row.kind, row.way)
            continue
        pins = block.pins[i - block.first]
        if row.sensor and pins[0] is not None:
            wire(picture, x + left, x + BLOCK[0], middle, row.kind, row.way)
        if row.board and pins[1] is not None:
            wire(picture, x + sum(BLOCK), x + right, middle, 'signal', row.board_way or row.way)
    if panel.block is not None:
        draw_block(picture, x, y, panel.block)
    y += len(panel.rows) * ROW + 28 if panel.rows else -18
    for remark in panel.remarks:
        y = picture.lines(x + 12, y, wrap(remark, 11, PANEL - 24), 11, color=svg.MUTED) + 3
    return y


def draw_one(facts):
    """Drawn twice: the first time to see how high the panels are."""
    height = 0
    for _ in range(2):
        width = 3 * PANEL + 2 * GAP + 48
        picture = svg.Picture(width, TOP + 700, facts.title, facts.description)
        picture.head(facts.subtitle)
        ends = [draw_panel(picture, 24 + i * (PANEL + GAP), height, panel) for i, panel in enumerate(facts.panels)]
        height = max(ends) - TOP - 2
        y = TOP + height + 26
        for note in facts.notes:
            lines = wrap(note, 11.5, width - 48)
            y = picture.lines(24, y, lines, 11.5) + 4
        picture.height = int(y + 4)
    return picture.whole()


def draw(_):
    return {f'wiring_{facts.name}.svg': draw_one(facts) for facts in PICTURES}
