# SPDX-License-Identifier: MIT
"""What traces.c prints: events in time."""
import csv
from collections import namedtuple

Event = namedtuple('Event', 'begin_us end_us what text')
Frame = namedtuple('Frame', 'begin_us end_us what bytes')


class Unexpected(Exception):
    """A trace that does not show what its picture is to tell."""


def read(text):
    rows = csv.reader(text.splitlines())
    return [Event(float(begin), float(end), what, said) for begin, end, what, said in rows]


def of(events, *whats):
    return [event for event in events if event.what in whats]


def one(events, what, text=None, after_us=float('-inf')):
    """The first such event after that time."""
    for event in events:
        if event.what == what and event.begin_us >= after_us and (text is None or event.text == text):
            return event
    raise Unexpected(f'no event {what} {text or ""} after {after_us} us')


def frames(events):
    """Bytes of one direction without a silence between them."""
    found = []
    for event in of(events, 'sent', 'came'):
        last = found[-1] if found else None
        if last and last.what == event.what and event.begin_us - last.end_us < 3:
            found[-1] = last._replace(end_us=event.end_us, bytes=[*last.bytes, event.text])
        else:
            found.append(Frame(event.begin_us, event.end_us, event.what, [event.text]))
    return found


def demand(condition, what):
    if not condition:
        raise Unexpected(what)
