# SPDX-License-Identifier: MIT
"""One transaction on the wire, from the trace of firmware in a simulator."""
import svg
from events import demand, frames, of

BITS = 11  # start, 8 data, even parity, stop
BAUD = 19200
T3_5_US = 3.5 * BITS * 1e6 / BAUD
LABELS, LEFT, RIGHT, PER_MS = 24, 150, 1029, 42  # in the picture


def x_of(us):
    return LEFT + 18 + us / 1000 * PER_MS


def levels(events):
    """Edges that the bytes make, as (us, level): start bit, data from the lowest bit on, even parity, stop bit."""
    edges = []
    for event in events:
        byte = int(event.text, 16)
        data = [byte >> i & 1 for i in range(8)]
        level = 1
        for i, bit in enumerate([0, *data, sum(data) & 1, 1]):
            if bit != level:
                edges.append((event.begin_us + i * (event.end_us - event.begin_us) / BITS, bit))
            level = bit
    return edges


def steps(edges, left, right, high, low):
    """The line of a signal through its edges, which are (x, level); before the first one it has the other level."""
    level = 1 - edges[0][1] if edges else 1
    points = [(left, high if level else low)]
    for x, new in edges:
        points += [(x, high if level else low), (x, high if new else low)]
        level = new
    return [*points, (right, high if level else low)]


def check(request, response, following, driver):
    demand(len(request.bytes) == 8 and len(response.bytes) == 13, 'a request of 8 bytes and a response of 13')
    demand(driver[0].begin_us <= request.begin_us and request.end_us <= driver[0].end_us < response.begin_us,
           'the driver is on around the request, and off before the response')
    demand(following.begin_us - response.end_us >= T3_5_US, 'an inter-frame gap of t3.5')


def draw_lanes(picture, events, driver):
    for y, name, detail in ((108, 'driver-enable', 'PD2, to DE and /RE'), (160, 'from the board', 'TXD, PD1'),
                            (202, 'from the sensor', 'RXD, PD0'), (252, 'level of the pair', 'A over B is high')):
        picture.text(LABELS, y, name, 12.5, bold=True)
        picture.text(LABELS, y + 15, detail, 10.5, svg.MUTED, within=LEFT - LABELS - 2)
    edges = [(x_of(us), level) for event in driver for us, level in ((event.begin_us, 1), (event.end_us, 0))]
    picture.path(steps([edge for edge in edges if edge[0] < RIGHT], LEFT, RIGHT, 96, 120), svg.VIOLET[1])
    for y in (172, 214):
        picture.path([(LEFT, y), (RIGHT, y)], svg.RULE, 1)
    shown = [event for event in of(events, 'sent', 'came') if x_of(event.end_us) < RIGHT + 2]
    for event in shown:
        x, width = x_of(event.begin_us), x_of(event.end_us) - x_of(event.begin_us)
        sent = event.what == 'sent'
        picture.rect(x, 148 if sent else 190, width, 24, svg.BLUE if sent else svg.GREEN)
        picture.text(x + width / 2, 164 if sent else 206, event.text, 10.5, anchor='middle', mono=True)
    picture.path(steps([(x_of(us), level) for us, level in levels(shown)], LEFT, RIGHT, 242, 266), line=1.2)


def draw_spans(picture, request, response, following):
    y = 292
    for us in (request.begin_us, request.end_us, response.begin_us, response.end_us, following.begin_us):
        picture.path([(x_of(us), 84), (x_of(us), y - 5)], svg.RULE, 1, '3 3')
    mm = int(response.bytes[3] + response.bytes[4], 16)
    for begin, end, name, color, texts in (
            (request.begin_us, request.end_us, 'request', svg.BLUE[1],
             ('unit 1: read 4 registers', 'from 0x0008, CRC')),
            (request.end_us, response.begin_us, 'turnaround', svg.MUTED, ()),
            (response.begin_us, response.end_us, 'response', svg.GREEN[1],
             (f'unit 1: 8 bytes, of which 0x{response.bytes[3]}{response.bytes[4]} is {mm} mm;',
              'magnitude, ambient light, precision; CRC')),
            (response.end_us, following.begin_us, 'inter-frame gap', svg.MUTED,
             ('at least 3.5 characters,', f'{T3_5_US / 1000:.2f} ms'))):
        picture.span(x_of(begin), x_of(end), y, color)
        middle = (x_of(begin) + x_of(end)) / 2
        picture.text(middle, y + 19, name, 12.5, color, 'middle', bold=True)
        picture.text(middle, y + 35, f'{(end - begin) / 1000:.2f} ms', 11.5, svg.MUTED, 'middle')
        picture.lines(middle, y + 54, texts, 10.5, color=svg.MUTED, anchor='middle')
    picture.text(x_of(following.begin_us) + 4, 138, 'next request', 10.5, svg.BLUE[1])


def zoom(picture, x, title, driver_edge, edge_us, edges, bits):
    """150 us around an edge of the driver, (us, level). edge_us: the end of what the driver covers; bits: (us, name) of
    each, and an end."""
    y, width, per_us = 398, 452, 2.5
    picture.rect(x, y, width, 118, (svg.PAPER, svg.RULE), 6)
    picture.text(x + 14, y + 22, title, 12.5, bold=True)
    left, right = x + 58, x + width - 12
    middle = left + 44 if driver_edge[1] else right - 44
    def at(us):
        return middle + (us - edge_us) * per_us
    picture.text(x + 14, y + 54, 'PD2', 10.5, svg.VIOLET[1])
    picture.text(x + 14, y + 87, 'PD1', 10.5, svg.BLUE[1])
    for us in (driver_edge[0], *(us for us, _ in bits if left < at(us) < right)):
        picture.path([(at(us), y + 34), (at(us), y + 98)], svg.MUTED, 1, '2 3')
    picture.path(steps([(at(driver_edge[0]), driver_edge[1])], left, right, y + 38, y + 58), svg.VIOLET[1], 1.8)
    shown = [(at(us), level) for us, level in edges if left < at(us) < right]
    picture.path(steps(shown, left, right, y + 72, y + 92), svg.BLUE[1], 1.8)
    for (begin, name), (end, _) in zip(bits, bits[1:]):
        shown_middle = (max(at(begin), left) + min(at(end), right)) / 2
        picture.text(shown_middle, y + 110, name, 10.5, svg.MUTED, 'middle')


def draw_zooms(picture, events, request, driver):
    edges = levels(of(events, 'sent'))
    end, bit = request.end_us, (request.end_us - request.begin_us) / len(request.bytes) / BITS
    first, last = int(request.bytes[0], 16), int(request.bytes[-1], 16)
    zoom(picture, 56, f'Driver on {-driver.begin_us:.1f} µs before the first start bit', (driver.begin_us, 1), 0, edges,
         [(0, 'start bit'), (bit, f'bit 0 is {first & 1}'), (2 * bit, f'bit 1 is {first >> 1 & 1}'), (3 * bit, '')])
    zoom(picture, 540, f'Driver off {driver.end_us - end:.1f} µs after the last stop bit', (driver.end_us, 0), end, edges,
         [(end - 3 * bit, f'bit 7 is {last >> 7}'), (end - 2 * bit, f'parity is {bin(last).count("1") & 1}'),
          (end - bit, 'stop bit'), (end, '')])


def draw(traces):
    events = traces['transaction']
    driver = of(events, 'driver')
    request, response, following = frames(events)
    check(request, response, following, driver)
    picture = svg.Picture(1048, 576, 'One transaction on an RS-485 pair', (
        'From the top: driver-enable of the transceiver, the bytes of request and response, and the level of the pair. '
        f'The request takes {request.end_us / 1000:.2f} ms; after a turnaround the unit responds; after an inter-frame '
        'gap of at least 3.5 characters the next request leaves. Driver-enable is high while the request is on the '
        'wire, and for a few microseconds around it.'))
    picture.head('An ATmega328P at 16 MHz asks an HPS-167S, 19200 8E1: the image of examples/avr/hps167s_rs485.c, traced '
                 'in a simulator')
    draw_lanes(picture, events, driver)
    draw_spans(picture, request, response, following)
    draw_zooms(picture, events, request, driver[0])
    picture.lines(24, 542, [
        'The response time-out, 500 ms here, runs from the end of the request to the first byte of the response. The '
        'gap is longer than it has to be,', 'since this sensor measures 54 times a second.'], 11, color=svg.MUTED)
    return {'transaction.svg': picture.whole()}
