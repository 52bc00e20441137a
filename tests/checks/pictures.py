#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The pictures of src/pictures are plain SVG, and what they name is there: the headers and ports of layers.svg, and the
modules of the tool, of which tool.svg has each."""
import os
import re
import xml.etree.ElementTree as ET

from common import files, main, read

FOLDER, TOOL = 'src/pictures', 'examples/fathom'
MOST_BYTES = 30000


def broken_rules(text):
    """What no picture may be."""
    tags = [element.tag.rsplit('}', 1)[-1] for element in ET.fromstring(text).iter()]
    if tags[1:3] != ['title', 'desc']:
        yield 'title and description do not come first'
    if 'fill="#ffffff"/>' not in text.split('\n')[4]:
        yield 'no white paper'
    if re.search(r'href|url\(|@import|<image|<script|<!', text):
        yield 'a reference to elsewhere'
    if len(text.encode()) > MOST_BYTES:
        yield f'over {MOST_BYTES} bytes'


def unknown_names(root):
    text = read(root, f'{FOLDER}/layers.svg')
    known = {os.path.basename(path)[:-2] for path in files(root, 'include', ends='.h')}
    known.update(os.listdir(os.path.join(root, 'port')))
    for names in re.findall(r'class="m">(.*)</text>', text):
        yield from (f'{FOLDER}/layers.svg: there is no {name}'
                    for name in names.replace(', ...', '').split(', ') if name not in known)


def other_modules(root):
    drawn = set(re.findall(r'font-weight="bold">([\w/]+)/</text>', read(root, f'{FOLDER}/tool.svg')))
    yield from (f'{FOLDER}/tool.svg: there is no {name}' for name in sorted(drawn)
                if not os.path.isdir(os.path.join(root, TOOL, name)))
    sources = {path[len(TOOL) + 1:] for path in files(root, TOOL, ends='.c')}
    modules = {path.split('/')[0] for path in sources if '/' in path}
    yield from (f'{FOLDER}/tool.svg: lacks {name}' for name in sorted(modules - drawn))


def check(root):
    problems = [f'{path}: {problem}' for path in files(root, FOLDER, ends='.svg')
                for problem in broken_rules(read(root, path))]
    return problems + [*unknown_names(root), *other_modules(root)]


if __name__ == '__main__':
    main(check)
