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
import subprocess
import sys

sys.dont_write_bytecode = True
import events
import layers
import quarantine
import resync
import transaction
import wiring

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
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


def draw_all():
    traces = {name: events.read(load(trace_path(name))) for name in (FIRMWARE, *SIMULATED)}
    drawn = {}
    for family in FAMILIES:
        drawn.update(family.draw(traces))
    return drawn


def stale_pictures(drawn, folder):
    problems = [f'src/pictures/{name}: nothing draws it' for name in sorted(set(os.listdir(folder)) - set(drawn))
                if name.endswith('.svg')]
    for name, text in drawn.items():
        path = os.path.join(folder, name)
        if not os.path.exists(path) or load(path) != text:
            problems.append(f'src/pictures/{name}: not what tests/pictures/pictures.py draws')
    return problems


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--sim')
    parser.add_argument('--avr')
    for mode in ('--check', '--compare', '--self-test'):
        parser.add_argument(mode, action='store_true')
    options = parser.parse_args()
    for name, text in made_by(options).items():
        save(trace_path(name), text)
    for name, text in draw_all().items():
        save(os.path.join(PICTURES, name), text)


if __name__ == '__main__':
    main()
