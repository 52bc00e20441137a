#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prepares one file for Doxygen: the filter that the Doxyfile beside this script names.

    doxygen.py FILE    prints FILE with the same number of lines

In a header, everything below a line `/* private */` of a struct is hidden, down to the brace that closes the struct.
In a page, each heading gets the anchor that GitHub gives it, and each link to a page, a heading or a public header
leads there. A link to any other file of the tree becomes plain text, because the HTML does not contain that file."""
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MAIN = 'README.md'
PAGES = ('README.md', 'CHANGELOG.md', '.github/SECURITY.md', 'include/', 'src/', 'port/', 'examples/')

PICTURES = 'src/pictures/'

PRIVATE = re.compile(r'^([ \t]*)/\* private:? \*/[ \t]*$', re.M)
FENCE = re.compile(r'^```.*?^```$', re.M | re.S)
LINK = re.compile(r'(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)')


def without_private(text):
    """Hides the private members of each struct by @cond."""
    out, at = [], 0
    for found in PRIVATE.finditer(text):
        if found.start() < at:
            continue
        # The brace that closes the struct stands one step further left than its members.
        close = re.compile(rf'^{found[1][:-4]}\}}', re.M).search(text, found.end())
        if not close:
            continue
        out += [text[at:found.start()], found[1], '/** @cond private */', text[found.end():close.start()],
                found[1][:-4], '/** @endcond */']
        at = close.start() + len(found[1][:-4])
    return ''.join([*out, text[at:]])


def header(text):
    """A header for Doxygen, which reports a name without a comment only in a file that has a comment `@file`."""
    mark = '' if re.search(r'[@\\]file\b', text) else '/** @file */'
    return mark + without_private(text)


def page_id(path):
    """The name of a page. Doxygen makes `mainpage` the first page, and calls this page `index`."""
    return 'index' if path == MAIN else 'page_' + re.sub(r'\W+', '_', os.path.splitext(path)[0]).strip('_').lower()


def anchor_of(heading):
    """The anchor that GitHub gives a heading."""
    return re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')


def is_page(path):
    return path.endswith('.md') and path.startswith(PAGES) and os.path.isfile(os.path.join(ROOT, path))


def is_header(path):
    return re.match(r'include/fathom/.*\.h$|port/\w+/fathom_\w+\.h$', path) is not None


def link(path, found):
    """The link as Doxygen understands it, on as many lines."""
    is_picture, text, target = found[1], ' '.join(found[2].split()), found[3]
    lines = '\n' * found[0].count('\n')
    name, _, anchor = target.partition('#')
    there = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
    if os.path.isdir(os.path.join(ROOT, there)):
        there = os.path.join(there, MAIN)
    if '://' in target:
        pass
    elif is_page(there):
        target = f'@ref {page_id(there)}{"_" + anchor if anchor else ""}'
    elif is_header(there):
        target = f'@ref {there}'
    elif there.startswith(PICTURES):
        target = os.path.basename(there)  # Doxygen copies all pictures beside the pages
    else:
        return text + lines
    return f'{is_picture}[{text}]({target}){lines}'


def page(path, text):
    """A page with Doxygen's names for its headings and links; programs and code stay as they are."""
    seen = set()

    def prose(part, is_first):
        lines = []
        for line in part.split('\n'):
            heading = re.match(r'(#+) (.*)$', line)
            if heading and heading[1] == '#' and is_first:
                line = f'# {heading[2]} {{#{"mainpage" if path == MAIN else page_id(path)}}}'
                is_first = False
            elif heading and anchor_of(heading[2]) not in seen:  # a link leads to the first heading of a name
                seen.add(anchor_of(heading[2]))
                line = f'{heading[1]} {heading[2]} {{#{page_id(path)}_{anchor_of(heading[2])}}}'
            lines.append(line)
        return LINK.sub(lambda found: link(path, found), '\n'.join(lines))

    out, at = [], 0
    for fence in FENCE.finditer(text):
        out += [prose(text[at:fence.start()], at == 0), fence[0]]
        at = fence.end()
    return ''.join([*out, prose(text[at:], at == 0)])


def main():
    path = os.path.relpath(os.path.abspath(sys.argv[1]), ROOT)
    with open(sys.argv[1], encoding='utf-8') as file:
        text = file.read()
    sys.stdout.reconfigure(encoding='utf-8')
    sys.stdout.write(page(path, text) if path.endswith('.md') else header(text))


if __name__ == '__main__':
    main()
