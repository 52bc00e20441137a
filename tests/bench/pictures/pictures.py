#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pictures of src/pictures, from the traces in traces/ and from what the modules here draw.

    pictures.py                                      draws them
    pictures.py --sim PROGRAM [--avr PROGRAM]        makes the traces anew by these programs, then draws
    pictures.py --check [--sim PROGRAM]              fails where a picture, or a trace of PROGRAM, is not the kept one
    pictures.py --compare --avr PROGRAM              fails where its trace is not the kept one, to 50 us
    pictures.py --self-test                          shows that the comparisons and the drawing can fail
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET

sys.dont_write_bytecode = True
import events
import layers
import quarantine
import resync
import svg
import transaction
import wiring

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
PICTURES = os.path.join(ROOT, 'src', 'pictures')
TRACES = os.path.join(HERE, 'traces')
SIMULATED = ('quarantine', 'resync-silence', 'resync-none', 'resync-repeated')
FIRMWARE = 'transaction'
MOST_US = 50
FAMILIES = (transaction, quarantine, resync, layers, wiring)


def load(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def save(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='utf-8', newline='\n') as file:
        file.write(text)


def trace_path(name):
    return os.path.join(TRACES, name + '.csv')


def output_of(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def made_by(options):
    """Traces as the programs make them today."""
    made = {name: output_of(options.sim, name) for name in SIMULATED} if options.sim else {}
    if options.avr:
        made[FIRMWARE] = output_of(options.avr)
    return made


def load_traces():
    return {name: events.read(load(trace_path(name))) for name in (FIRMWARE, *SIMULATED)}


def draw_all(traces):
    drawn = {}
    for family in FAMILIES:
        drawn.update(family.draw(traces))
    return drawn


def broken_rules(name, text):
    """What no picture may be."""
    problems = []
    tags = [element.tag.rsplit('}', 1)[-1] for element in ET.fromstring(text).iter()]
    if tags[1:3] != ['title', 'desc']:
        problems.append('title and description do not come first')
    if 'fill="#ffffff"/>' not in text.split('\n')[4]:
        problems.append('no white paper')
    if re.search(r'href|url\(|@import|<image|<script|<!', text):
        problems.append('a reference to elsewhere')
    if len(text.encode()) > svg.MOST_BYTES:
        problems.append(f'over {svg.MOST_BYTES} bytes')
    return [f'src/pictures/{name}: {problem}' for problem in problems]


def other_pictures(drawn, folder):
    problems = [f'src/pictures/{name}: nothing draws it' for name in sorted(set(os.listdir(folder)) - set(drawn))
                if name.endswith('.svg')]
    for name, text in drawn.items():
        path = os.path.join(folder, name)
        if not os.path.exists(path) or load(path) != text:
            problems.append(f'src/pictures/{name}: not what tests/bench/pictures/pictures.py draws')
    return problems


def other_traces(made, most_us):
    return [f'tests/bench/pictures/traces/{name}.csv: {difference}' for name, text in made.items()
            for difference in events.differences(events.read(load(trace_path(name))), events.read(text), most_us)]


def check(made):
    drawn = draw_all(load_traces())
    return (other_traces(made, 0) + other_pictures(drawn, PICTURES) +
            [problem for name, text in drawn.items() for problem in broken_rules(name, text)])


def compare(made):
    problems = other_traces(made, MOST_US)
    print(*problems, sep='\n', end='\n' if problems else '')
    print(f'{len(made) - bool(problems)} passed, {int(bool(problems))} failed')
    return bool(problems) or not made


def report(problems):
    print(*problems, f'{len(problems)} problems', sep='\n')
    return bool(problems)


def refuses(draw, *arguments):
    """Does it end with an error of ours?"""
    try:
        draw(*arguments)
    except (svg.Overlap, events.Unexpected):
        return True
    return False


def moved(trace, by_us):
    return [trace[0]._replace(end_us=trace[0].end_us + by_us), *trace[1:]]


def self_test():
    """Each fault has to be found; the first row of each comparison is one that is none."""
    traces = load_traces()
    drawn = draw_all(traces)
    name = 'transaction.svg'
    text = drawn[name]
    paper = svg.Picture(100, 50, 'title', 'description')
    paper.text(10, 20, 'one')
    firmware, simulated = traces[FIRMWARE], traces['quarantine']
    not_late = [event for event in simulated if event.what != 'late']
    no_driver = [event._replace(end_us=event.end_us - 10) if event.what == 'driver' else event for event in firmware]
    with tempfile.TemporaryDirectory() as folder:
        for other, whole in drawn.items():
            save(os.path.join(folder, other), whole)
        faults = [('nothing', not other_pictures(drawn, folder))]
        save(os.path.join(folder, name), text.replace('4.58 ms', '4.59 ms', 1))
        faults.append(('a picture that was changed', other_pictures(drawn, folder)))
        save(os.path.join(folder, name), text)
        os.remove(os.path.join(folder, 'layers.svg'))
        faults.append(('a picture that is missing', other_pictures(drawn, folder)))
        save(os.path.join(folder, 'layers.svg'), drawn['layers.svg'])
        save(os.path.join(folder, 'another.svg'), text)
        faults.append(('a picture that nothing draws', other_pictures(drawn, folder)))
    faults += [
        ('no broken rule', not broken_rules(name, text)),
        ('a reference to elsewhere', broken_rules(name, text.replace('</svg>', '<image href="x.png"/></svg>'))),
        ('no description', broken_rules(name, re.sub('<desc>.*</desc>', '', text))),
        ('too many bytes', broken_rules(name, text + '\n' * svg.MOST_BYTES)),
        ('an event within 50 us', not events.differences(firmware, moved(firmware, MOST_US), MOST_US)),
        ('an event 51 us later', events.differences(firmware, moved(firmware, MOST_US + 1), MOST_US)),
        ('an event less', events.differences(firmware, firmware[1:], MOST_US)),
        ('text beside text', not refuses(paper.text, 50, 20, 'two')),
        ('text on text', refuses(paper.text, 12, 24, 'three')),
        ('text outside', refuses(paper.text, 80, 40, 'outside')),
        ('a trace with what its picture tells', not refuses(quarantine.draw, traces)),
        ('no late response', refuses(quarantine.draw, {**traces, 'quarantine': not_late})),
        ('the driver off in the last stop bit', refuses(transaction.draw, {**traces, FIRMWARE: no_driver})),
        ('a stream with silences for one without', refuses(resync.draw, {**traces, 'resync-none': traces['resync-silence']})),
    ]
    missed = [fault for fault, found in faults if not found]
    print(*(f'not as expected: {fault}' for fault in missed), f'{len(faults)} cases, {len(missed)} not as expected',
          sep='\n')
    return bool(missed)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--sim')
    parser.add_argument('--avr')
    for mode in ('--check', '--compare', '--self-test'):
        parser.add_argument(mode, action='store_true')
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    made = made_by(options)
    if options.check:
        return report(check(made))
    if options.compare:
        return compare(made)
    for name, text in made.items():
        save(trace_path(name), text)
    for name, text in draw_all(load_traces()).items():
        save(os.path.join(PICTURES, name), text)
    return 0


if __name__ == '__main__':
    sys.exit(main())
