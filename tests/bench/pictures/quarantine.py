# SPDX-License-Identifier: MIT
"""A response that comes after its time-out, from the trace of two drivers on one simulated line."""
import svg
from events import demand, frames, of, one

TIMEOUT_US = 30000
LABELS, LEFT, RIGHT, PER_MS = 24, 142, 1024, 10.8  # in the picture
BYTES, WAITS, TOLD, AXIS = 118, (186, 256), 324, 382  # lanes: the line; units 1 and 2


class Story:
    """The frames around the late response; times in us from the start of the request that it belongs to."""
    def __init__(self, events):
        late = one(events, 'late')
        found = frames(events)
        asked = [frame for frame in found if frame.what == 'sent' and frame.bytes[0] == '01']
        self.request = [frame for frame in asked if frame.begin_us < late.begin_us][-1]
        self.next_request = next(frame for frame in asked if frame.begin_us > late.begin_us)
        self.zero_us = self.request.begin_us
        self.frames = [frame for frame in found if frame.begin_us >= self.zero_us]
        self.late = next(frame for frame in self.frames if frame.end_us == late.begin_us)
        self.time_out = one(events, 'outcome', 'unit 1 time-out')
        self.begins = one(events, 'quarantine', 'begins')
        self.ends = one(events, 'quarantine', 'ends')
        self.outcomes = [event for event in of(events, 'outcome') if event.begin_us > self.zero_us]
        self.check(events)

    def check(self, events):
        demand(len(of(events, 'late')) == 1 and len(of(events, 'quarantine')) == 2, 'one late response, one quarantine')
        demand(self.time_out.begin_us == self.request.end_us + TIMEOUT_US, 'the time-out begins where the request ends')
        demand(self.begins.begin_us == self.time_out.begin_us and self.ends.begin_us == self.late.end_us,
               'the quarantine lasts from the time-out to the end of the late response')
        inside = [frame for frame in self.frames if self.begins.begin_us <= frame.begin_us < self.ends.begin_us]
        demand([frame.what + frame.bytes[0] for frame in inside] == ['sent02', 'came02', 'came01'],
               'in the quarantine unit 2 is asked and responds, and unit 1 is not asked')
        demand([event.text for event in self.outcomes] ==
               ['unit 1 time-out', 'unit 2 reading 3000 mm', 'unit 1 reading 3000 mm'], 'what the program is told')

    def x_of(self, us):
        return LEFT + 8 + (us - self.zero_us) / 1000 * PER_MS


def draw_line(picture, story):
    picture.text(LABELS, BYTES + 16, 'the line', 12.5, bold=True)
    picture.text(LABELS, BYTES + 31, '19200 8E1', 10.5, svg.MUTED)
    picture.path([(LEFT, BYTES + 24), (RIGHT, BYTES + 24)], svg.RULE, 1)
    for frame in story.frames:
        x, end = story.x_of(frame.begin_us), story.x_of(frame.end_us)
        colors = svg.BLUE if frame.what == 'sent' else svg.RED if frame is story.late else svg.GREEN
        picture.rect(x, BYTES, end - x, 24, colors)
        picture.text((x + end) / 2, BYTES + 16, str(int(frame.bytes[0], 16)), 12, colors[1], 'middle', bold=True)
    y = 96
    for colors, x, text in ((svg.BLUE, 150, 'request, with its unit'), (svg.GREEN, 314, 'response'),
                            (svg.RED, 406, 'late response: whole, with a right CRC')):
        picture.rect(x, y - 10, 13, 12, colors)
        picture.text(x + 19, y, text, 11, svg.MUTED)


def bar(picture, y, x, end, colors, text, dash=None):
    picture.rect(x, y, end - x, 26, colors, 3, dash=dash)
    picture.text((x + end) / 2, y + 17, text, 11.5, colors[1], 'middle', within=end - x - 4)


def draw_unit_1(picture, story):
    y = WAITS[0]
    x_of = story.x_of
    picture.text(LABELS, y + 17, 'unit 1', 12.5, bold=True)
    asked, out, free = x_of(story.request.end_us), x_of(story.begins.begin_us), x_of(story.ends.begin_us)
    at_most = x_of(story.request.end_us + 2 * TIMEOUT_US)
    bar(picture, y, asked, out, svg.BLUE, f'response time-out, {TIMEOUT_US / 1000:.0f} ms')
    bar(picture, y, out, free, svg.VIOLET, 'quarantine: not asked')
    picture.rect(free, y, at_most - free, 26, (svg.PAPER, svg.VIOLET[1]), 0, dash='3 3')
    answered = next(event for event in story.outcomes if event.text == 'unit 1 reading 3000 mm').begin_us
    bar(picture, y, x_of(story.next_request.end_us), x_of(answered), svg.BLUE, 'waits')
    picture.text(free + 6, y + 41, 'at most until twice the time-out', 10.5, svg.VIOLET[1])


def draw_unit_2(picture, story):
    y = WAITS[1]
    picture.text(LABELS, y + 17, 'unit 2', 12.5, bold=True)
    asked = next(frame for frame in story.frames if frame.what == 'sent' and frame.bytes[0] == '02')
    told = next(event for event in story.outcomes if event.text.startswith('unit 2'))
    bar(picture, y, story.x_of(asked.end_us), story.x_of(told.begin_us), svg.BLUE, 'asked meanwhile')


def draw_told(picture, story):
    y = TOLD
    picture.text(LABELS, y, 'the program', 12.5, bold=True)
    picture.text(LABELS, y + 15, 'is told', 10.5, svg.MUTED)
    for event, text, colors in zip(story.outcomes, ('unit 1: no response', 'unit 2: 3000 mm', 'unit 1: 3000 mm'),
                                   (svg.RED, svg.GREEN, svg.GREEN)):
        x = story.x_of(event.begin_us)
        picture.path([(x, BYTES + 26), (x, y - 17)], svg.RULE, 1, '3 3')
        picture.dot(x, y - 12, colors[1])
        picture.text(x, y + 8, text, 11.5, colors[1], 'middle', bold=True)
    x = story.x_of(story.ends.begin_us)
    picture.path([(x, BYTES + 26), (x, y - 17)], svg.RULE, 1, '3 3')
    picture.dot(x, y - 12, svg.RED[1], hollow=True)
    picture.lines(x, y + 8, ('nothing: the late', 'response is counted', 'and dropped'), 11, color=svg.RED[1],
                  anchor='middle')


def draw_axis(picture, story):
    y = AXIS
    picture.path([(LEFT, y), (RIGHT, y)], svg.MUTED, 1)
    for ms in range(0, 81, 10):
        x = story.x_of(story.zero_us + ms * 1000)
        picture.path([(x, y), (x, y + 5)], svg.MUTED, 1)
        picture.text(x, y + 19, f'{ms} ms' if ms % 20 == 0 else str(ms), 10.5, svg.MUTED, 'middle')


def draw(traces):
    story = Story(traces['quarantine'])
    picture = svg.Picture(1048, 470, 'A late response, and the quarantine of its unit', (
        'Unit 1 does not respond within its response time-out of 30 ms. It is in quarantine until its late response has '
        'come or twice the time-out is over: nothing is asked of it, so that the late response is not taken for that to '
        'a new request. Unit 2 is asked meanwhile. The late response ends the quarantine and is dropped; after the '
        'inter-frame gap unit 1 is asked anew.'))
    took_us = story.late.begin_us - story.request.end_us
    picture.head(f'Two HPS-167S on one line; unit 1 takes {took_us / 1000:.0f} ms where {TIMEOUT_US / 1000:.0f} ms are '
                 'allowed. Drivers and line of the library, simulated devices and time')
    draw_axis(picture, story)
    draw_told(picture, story)
    draw_line(picture, story)
    draw_unit_1(picture, story)
    draw_unit_2(picture, story)
    picture.lines(24, 434, [
        'Without the quarantine a new request to unit 1 could leave before the late response comes. That response, with '
        'an old distance, would pass for the new one:',
        'nothing in a Modbus response says which request it belongs to.'], 11, color=svg.MUTED)
    return {'quarantine.svg': picture.whole()}
