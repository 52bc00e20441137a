# SPDX-License-Identifier: MIT
"""A picture as SVG text: plain shapes, one font family, nothing from elsewhere. Two texts that overlap, and a text that
leaves the picture or its box, are errors, by the widths of DejaVu Sans, which is wider than most of its kin."""
from xml.sax.saxutils import escape

# name: (fill, stroke)
INK, MUTED, RULE, PAPER = '#1f2933', '#52606d', '#cbd2d9', '#ffffff'
BLUE, GREEN = ('#d8e8fc', '#1d5fb8'), ('#d6f0dd', '#1c7a3c')
RED, AMBER = ('#fbdcda', '#b3261e'), ('#fdebc8', '#9a5b00')
VIOLET, GREY = ('#e9e0fa', '#6b3fb5'), ('#eef1f4', '#7b8794')

MOST_BYTES = 30000
FONTS = 'Helvetica,Arial,\'DejaVu Sans\',sans-serif'
MONO = '\'DejaVu Sans Mono\',Menlo,Consolas,monospace'
# Hundredths of the size, from the space on.
WIDTHS = [32, 41, 46, 84, 64, 96, 78, 28, 40, 40, 50, 84, 32, 37, 32, 34, 64, 64, 64, 64, 64, 64, 64, 64, 64, 64, 34, 34,
          84, 84, 84, 54, 100, 69, 69, 70, 78, 64, 58, 78, 76, 30, 30, 66, 56, 87, 75, 79, 61, 79, 70, 64, 62, 74, 69,
          99, 69, 62, 69, 40, 34, 40, 84, 50, 50, 62, 64, 55, 64, 62, 36, 64, 64, 28, 28, 58, 28, 98, 64, 62, 64, 64,
          42, 53, 40, 64, 60, 82, 60, 60, 53, 64, 34, 64, 84]


class Overlap(Exception):
    """Text that cannot be read."""


def text_width(text, size, bold=False, mono=False):
    if mono:
        return len(text) * size * 0.602
    hundredths = sum(WIDTHS[ord(c) - 32] if 32 <= ord(c) < 127 else 84 for c in text)
    return hundredths / 100 * size * (1.1 if bold else 1)


def number(value):
    """To a tenth, without a useless end."""
    text = f'{value:.1f}'
    text = text[:-2] if text.endswith('.0') else text
    return '0' if text == '-0' else text


class Picture:
    def __init__(self, width, height, title, description):
        self.width, self.height = width, height
        self.title, self.description = title, description
        self.parts, self.texts = [], []

    def add(self, name, **attributes):
        written = ''.join(f' {key.replace("_", "-")}="{number(value) if isinstance(value, (int, float)) else value}"'
                          for key, value in attributes.items() if value is not None)
        self.parts.append(f'<{name}{written}/>')

    def rect(self, x, y, width, height, colors=GREY, radius=0, line=1, dash=None):
        fill, stroke = colors
        self.add('rect', x=x, y=y, width=width, height=height, rx=radius or None, fill=fill,
                 stroke=stroke if line else None, stroke_width=line if line not in (0, 1) else None,
                 stroke_dasharray=dash)

    def path(self, points, color=INK, line=1.5, dash=None):
        """A line through the points."""
        d = 'M' + 'L'.join(f'{number(x)} {number(y)}' for x, y in points)
        self.add('path', d=d, fill='none', stroke=color, stroke_width=line if line != 1 else None,
                 stroke_dasharray=dash)

    def dot(self, x, y, color=INK, radius=3, hollow=False):
        self.add('circle', cx=x, cy=y, r=radius, fill=PAPER if hollow else color, stroke=color)

    def arrow(self, points, color=INK, line=1.5, dash=None, size=7):
        """A line through the points with a head at its end; both parts are straight up, down, left or right there."""
        (x0, y0), (x, y) = points[-2:]
        dx, dy = (x > x0) - (x < x0), (y > y0) - (y < y0)
        back = (x - dx * size, y - dy * size)
        self.path([*points[:-1], back], color, line, dash)
        half = size * 0.5
        d = 'M' + 'L'.join(f'{number(a)} {number(b)}' for a, b in (
            (x, y), (back[0] + dy * half, back[1] + dx * half), (back[0] - dy * half, back[1] - dx * half))) + 'Z'
        self.add('path', d=d, fill=color)

    def span(self, x0, x1, y, color=MUTED):
        """From here to there, with both ends marked."""
        self.path([(x0, y), (x1, y)], color, 1)
        for x in (x0, x1):
            self.path([(x, y - 4), (x, y + 4)], color, 1)

    def text(self, x, y, text, size=12, color=INK, anchor='start', bold=False, mono=False, within=None):
        """One line; y is its base line. within: it may not be wider."""
        width = text_width(text, size, bold, mono)
        if within is not None and width > within:
            raise Overlap(f'{self.title}: {text!r} is {width:.0f} wide, and has {within:.0f}')
        left = x - {'start': 0, 'middle': width / 2, 'end': width}[anchor]
        box = (left, y - 0.76 * size, left + width, y + 0.22 * size, text)
        if box[0] < 4 or box[1] < 4 or box[2] > self.width - 4 or box[3] > self.height - 4:
            raise Overlap(f'{self.title}: {text!r} leaves the picture')
        for other in self.texts:
            if box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3]:
                raise Overlap(f'{self.title}: {text!r} lies on {other[4]!r}')
        self.texts.append(box)
        attributes = f'x="{number(x)}" y="{number(y)}"'
        if size != 12:
            attributes += f' font-size="{number(size)}"'
        if color != INK:
            attributes += f' fill="{color}"'
        if anchor != 'start':
            attributes += f' text-anchor="{anchor}"'
        if bold:
            attributes += ' font-weight="bold"'
        if mono:
            attributes += ' class="m"'
        self.parts.append(f'<text {attributes}>{escape(text)}</text>')

    def lines(self, x, y, texts, size=12, gap=1.4, **how):
        """One below the other; returns where the next one would stand."""
        for text in texts:
            self.text(x, y, text, size, **how)
            y += size * gap
        return y

    def head(self, subtitle):
        self.text(24, 36, self.title, 19, bold=True)
        self.text(24, 57, subtitle, 12.5, MUTED, within=self.width - 40)

    def whole(self):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
                f'width="{self.width}" height="{self.height}" role="img" font-family="{FONTS}" font-size="12" '
                f'fill="{INK}">\n<title>{escape(self.title)}</title>\n<desc>{escape(self.description)}</desc>\n'
                f'<style>.m{{font-family:{MONO}}}</style>\n<rect width="{self.width}" height="{self.height}" rx="8" fill="{PAPER}"/>\n')
        whole = head + '\n'.join(self.parts) + '\n</svg>\n'
        if len(whole.encode()) > MOST_BYTES:
            raise Overlap(f'{self.title}: {len(whole)} bytes')
        return whole
