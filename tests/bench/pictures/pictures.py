#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the pictures of src/pictures, from traces of what the library does and from the modules here.

    pictures.py [--sim PROGRAM]           draws the pictures
    pictures.py --check [--sim PROGRAM]   fails if a picture is not the one that it would draw
    pictures.py --self-test               changes a picture and sees that

PROGRAM prints the traces. Without --sim the pictures of simulated lines are left out. transaction.svg is kept as it was
traced once, because its times depend on the compiler; --check asks the rules for it, too.
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
import tool
import wiring

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
PICTURES = os.path.join(ROOT, 'src', 'pictures')
SIMULATED = ('quarantine', 'resync-silence', 'resync-none', 'resync-repeated')
KEPT = 'transaction.svg'


def load(path):
    with open(path, encoding='utf-8') as file:
        return file.read()


def save(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='utf-8', newline='\n') as file:
        file.write(text)


def output_of(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def draw_all(options):
    """Returns {name: text} of all pictures that these programs have traces for."""
    drawn = {**layers.draw({}), **tool.draw({}), **wiring.draw({})}
    if options.sim:
        traces = {name: events.read(output_of(options.sim, name)) for name in SIMULATED}
        drawn.update(quarantine.draw(traces))
        drawn.update(resync.draw(traces))
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
    for name, text in drawn.items():
        path = os.path.join(folder, name)
        if not os.path.exists(path) or load(path) != text:
            yield f'src/pictures/{name}: not what tests/bench/pictures/pictures.py draws'


def check(options):
    drawn = draw_all(options)
    judged = {**drawn, KEPT: load(os.path.join(PICTURES, KEPT))}
    problems = [problem for name, text in judged.items() for problem in broken_rules(name, text)]
    problems += other_pictures(drawn, PICTURES)
    print(*problems, f'{len(drawn)} pictures, {len(problems)} problems', sep='\n')
    return bool(problems)


def self_test(options):
    drawn = draw_all(options)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in drawn.items():
            save(os.path.join(folder, name), text)
        none = list(other_pictures(drawn, folder))
        save(os.path.join(folder, 'layers.svg'), drawn['layers.svg'] + '<!-- changed -->')
        is_found = not none and len(list(other_pictures(drawn, folder))) == 1
    print(f'{int(is_found)} passed, {int(not is_found)} failed')
    return not is_found


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--sim')
    for mode in ('--check', '--self-test'):
        parser.add_argument(mode, action='store_true')
    options = parser.parse_args()
    if options.self_test:
        return self_test(options)
    if options.check:
        return check(options)
    for name, text in draw_all(options).items():
        save(os.path.join(PICTURES, name), text)
    return 0


if __name__ == '__main__':
    sys.exit(main())
