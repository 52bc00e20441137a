#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the pictures of src/pictures that show what happens on a wire, from traces of what the library does.

    pictures.py --sim PROGRAM           draws them
    pictures.py --check --sim PROGRAM   fails if one of them is not what it would draw, or if a picture breaks a rule

PROGRAM prints the traces. The other pictures are kept as they are; --check asks the rules for them, too."""
import argparse
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET

sys.dont_write_bytecode = True
import events
import quarantine
import resync
import svg

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
PICTURES = os.path.join(ROOT, 'src', 'pictures')
TOOL = os.path.join(ROOT, 'examples', 'fathom')
SIMULATED = ('quarantine', 'resync-silence', 'resync-none', 'resync-repeated')


def load(name):
    with open(os.path.join(PICTURES, name), encoding='utf-8') as file:
        return file.read()


def draw_all(program):
    """Returns {name: text} of the pictures that are drawn from traces."""
    traces = {name: events.read(subprocess.run([program, name], check=True, stdout=subprocess.PIPE, text=True).stdout)
              for name in SIMULATED}
    return {**quarantine.draw(traces), **resync.draw(traces)}


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


def other_names():
    """What layers.svg and tool.svg name and is not there, and modules of the tool that tool.svg lacks."""
    files = {file for _, _, names in os.walk(os.path.join(ROOT, 'include', 'fathom')) for file in names}
    ports = os.listdir(os.path.join(ROOT, 'port'))
    for names in re.findall(r'class="m">(.*)</text>', load('layers.svg')):
        yield from (f'src/pictures/layers.svg: there is no {name}' for name in names.replace(', ...', '').split(', ')
                    if name + '.h' not in files and name not in ports)
    drawn = set(re.findall(r'font-weight="bold">([\w/]+)/</text>', load('tool.svg')))
    yield from (f'src/pictures/tool.svg: there is no {name}' for name in sorted(drawn)
                if not os.path.isdir(os.path.join(TOOL, name)))
    modules = {os.path.relpath(here, TOOL).split(os.sep)[0] for here, _, names in os.walk(TOOL)
               if any(name.endswith('.c') for name in names)}
    yield from (f'src/pictures/tool.svg: lacks {name}' for name in sorted(modules - drawn - {'.'}))


def check(drawn):
    problems = [problem for name in sorted(os.listdir(PICTURES)) for problem in broken_rules(name, load(name))]
    problems += [f'src/pictures/{name}: not what tests/bench/pictures/pictures.py draws' for name, text in drawn.items()
                 if load(name) != text]
    problems += other_names()
    print(*problems, f'{len(drawn)} pictures drawn, {len(problems)} problems', sep='\n')
    return bool(problems)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('--sim', required=True)
    parser.add_argument('--check', action='store_true')
    options = parser.parse_args()
    drawn = draw_all(options.sim)
    if options.check:
        return check(drawn)
    for name, text in drawn.items():
        with open(os.path.join(PICTURES, name), 'w', encoding='utf-8', newline='\n') as file:
            file.write(text)
    return 0


if __name__ == '__main__':
    sys.exit(main())
