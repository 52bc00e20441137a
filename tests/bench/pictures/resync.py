# SPDX-License-Identifier: MIT
"""A byte lost from a stream, from traces of an A05's driver on a simulated line."""
import svg
from events import demand, of

LENGTH, SILENCE_US = 10, 5000  # of a frame; the default gap_us
LEFT, CELL, PAUSE, SHOWN = 24, 22, 26, 4  # in the picture; frames before the bytes of one more
TAIL = 2


class Stream:
    """Frames as the sensor sent them, and what was made of each. Bytes are None where they were lost."""
    def __init__(self, events):
        self.times = {}  # end of a byte: (frame, place)
        came = of(events, 'came')
        whole = [event.text for event in came[:LENGTH]]
        self.frames, at = [], 0
        while at < len(came):
            got = [event.text for event in came[at:at + LENGTH]]
            lost = None
            if got != whole[:len(got)]:
                lost = next(i for i in range(LENGTH) if got[i] != whole[i])
                got = whole[:lost] + [None] + whole[lost + 1:]
            places = [i for i in range(len(got)) if i != lost]
            for place, event in zip(places, came[at:]):
                self.times[event.end_us] = (len(self.frames), place)
            self.frames.append(got)
            at += len(places)
        self.damaged = [i for i, frame in enumerate(self.frames) if None in frame]
        demand(len(self.damaged) == 1, 'one byte lost')
        self.came = came
        self.readings = {self.times[event.begin_us][0]: event for event in of(events, 'reading')}
        self.refused = [(self.times[event.begin_us], event.text) for event in of(events, 'refused')]
        self.is_silent = came[LENGTH].begin_us - came[LENGTH - 1].end_us >= SILENCE_US

    def verdict(self, frame):
        if frame in self.readings:
            return 'reading'
        return 'lost' if frame in self.damaged else 'refused'


def cell_x(stream, first, frame, place):
    return LEFT + ((frame - first) * LENGTH + place) * CELL + (frame - first) * (PAUSE if stream.is_silent else 6)


def draw_frame(picture, stream, first, frame, y):
    colors = {'reading': svg.GREEN, 'lost': svg.RED, 'refused': svg.AMBER}[stream.verdict(frame)]
    places = TAIL if frame == first + SHOWN else LENGTH
    if places == TAIL:
        colors = svg.GREY
    for place, byte in enumerate(stream.frames[frame][:places]):
        x = cell_x(stream, first, frame, place)
        if byte is None:
            picture.rect(x, y, CELL, 26, (svg.PAPER, svg.RED[1]), dash='3 2')
            picture.path([(x + 6, y + 8), (x + 16, y + 18)], svg.RED[1])
            picture.path([(x + 16, y + 8), (x + 6, y + 18)], svg.RED[1])
        else:
            picture.rect(x, y, CELL, 26, colors)
            picture.text(x + CELL / 2, y + 17, byte, 11, anchor='middle', mono=True)


def note(picture, stream, first, frame, y, texts):
    x0, x1 = cell_x(stream, first, frame, 0), cell_x(stream, first, frame, LENGTH - 1) + CELL
    verdict = stream.verdict(frame)
    color = {'reading': svg.GREEN, 'lost': svg.RED, 'refused': svg.AMBER}[verdict][1]
    picture.span(x0 + 1, x1 - 1, y + 34, color)
    for i, text in enumerate(texts):
        picture.text((x0 + x1) / 2, y + 52 + 15 * i, text, 11.5, color, 'middle', bold=i == 0, within=x1 - x0)


def given(stream, frame):
    event = stream.readings[frame]
    if stream.is_silent:
        demand(event.end_us - event.begin_us == SILENCE_US, 'given when the silence has lasted')
        return f'given {(event.end_us - event.begin_us) / 1000:.0f} ms after its end'
    after = next(byte for byte in stream.came if byte.end_us == event.end_us)
    demand(after.text == 'FF' and stream.times[after.end_us] == (frame + 1, 0), 'given when the next frame begins')
    return 'given when the next FF comes'


def strip(picture, stream, y, title, detail, notes):
    first = stream.damaged[0] - 1
    picture.text(LEFT, y, title, 13.5, bold=True)
    picture.text(LEFT, y + 18, detail, 11.5, svg.MUTED)
    for frame in range(first, first + SHOWN + 1):
        draw_frame(picture, stream, first, frame, y + 30)
    for frame, texts in zip(range(first, first + SHOWN), notes):
        if stream.verdict(frame) == 'reading':
            texts = [stream.readings[frame].text.replace(' ', ', ') + ' mm', given(stream, frame)]
        note(picture, stream, first, frame, y + 30, texts)
    return first


def draw_other_alignment(picture, stream, y):
    """Where the same bytes make another frame with a right sum."""
    first = stream.damaged[0] - 1
    frame, place = first + 2, 6
    values = (stream.frames[frame] + stream.frames[frame + 1])[place:place + LENGTH]
    demand(values[0] == 'FF' and sum(int(v, 16) for v in values[:-1]) & 255 == int(values[-1], 16),
           'a right sum in another place')
    demand(any(at == (frame + 1, place - 1) for at, _ in stream.refused), 'and it was refused')
    mm = [int(values[i] + values[i + 1], 16) for i in range(1, LENGTH - 1, 2)]
    x0, x1 = cell_x(stream, first, frame, place), cell_x(stream, first, frame + 1, place - 1) + CELL
    picture.rect(x0 - 2, y + 27, x1 - x0 + 4, 32, ('none', svg.VIOLET[1]), 3, line=1.8)
    picture.arrow([(x0 + 60, y + 116), (x0 + 60, y + 61)], svg.VIOLET[1])
    picture.text(x0 - 140, y + 132, f'FF in front and a right sum here too: {", ".join(map(str, mm))} mm, the probes '
                 'permuted', 11.5, svg.VIOLET[1])


def draw(traces):
    silence, none, repeated = (Stream(traces[f'resync-{name}']) for name in ('silence', 'none', 'repeated'))
    demand([s.verdict(s.damaged[0] + i) for s in (silence, none) for i in (-1, 0, 1, 2)] ==
           ['reading', 'lost', 'reading', 'reading', 'reading', 'lost', 'refused', 'reading'], 'what is given')
    demand(not silence.refused and none.refused == [((none.damaged[0] + 1, LENGTH - 1), 'unsure')],
           'the frame behind the damaged one is the only right sum that is refused')
    demand(max(repeated.readings) < repeated.damaged[0] - 1, 'nothing is given where another place is as good')
    picture = svg.Picture(1076, 540, 'A byte is lost from a stream', (
        'Frames of an A05 in automatic output, FF, four distances, sum; the fifth byte of one is lost. Where a silence is '
        'seen between frames, the next frame is the next reading. Where none is seen, the next frame is refused, since '
        'its place is not proven, and the one after it is given. Where the values repeat a pattern that has a right sum '
        'in two places, nothing is given.'))
    picture.head('An A05 with automatic output, 9600 8N1: FF, four distances of two bytes, sum. The library\'s driver and '
                 'stream on a simulated line')
    strip(picture, silence, 96, 'A silence between frames is seen', 'The usual case on a microcontroller. A silence of '
          '5 ms shows where a frame begins and where it ends.',
          [None, ['refused', 'nine bytes are no frame'], None, None])
    strip(picture, none, 238, 'No silence is seen', 'Behind an operating system, for instance. A right sum does not '
          'prove where a frame begins; a second one right behind it does.',
          [None, ['refused', 'no right sum anywhere'], ['refused', 'a right sum, but no frame before it'], None])
    strip(picture, repeated, 380, 'No silence, and two places are as good',
          'Both have FF in front and a right sum. All is refused, and when the deadline is over the sensor is stale.',
          [['refused, ambiguous'], ['refused'], ['refused'], ['refused, ambiguous']])
    draw_other_alignment(picture, repeated, 380)
    return {'resync.svg': picture.whole()}
