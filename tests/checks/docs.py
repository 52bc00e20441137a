#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Doxygen finds a comment for every public name, and every link of the pages leads somewhere.

    docs.py            each warning of Doxygen as file:line
    docs.py --count    the number of warnings in each file

Doxygen reads include/Doxyfile, as the target docs does. This check adds five rules:

 1. Each header has a comment with @file and @brief.
 2. A function with two parameters or more has a @param for each. The only parameter of a function needs none.
 3. A function that returns a value has @return or @retval, unless its first sentence begins with "Returns".
 4. Each enumerator has a comment.
 5. Each mark /* private */ stands alone on a line of a struct."""
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from xml.etree import ElementTree

from common import ROOT, code_of, files, main, read

SETTINGS = """@INCLUDE = include/Doxyfile
OUTPUT_DIRECTORY = "{}"
WARN_AS_ERROR = NO
WARN_NO_PARAMDOC = YES
SEARCHENGINE = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
"""
PLACE = re.compile(r'(.+?):(\d+): (?:warning|error): (.*)')
FUNCTION = re.compile(r'^(?!#)[A-Za-z_][\w \t*\n]*?\b(\w+)\(([^;{}]*)\)\s*[;{]', re.M)
METHOD = re.compile(r'^ {4}[A-Za-z_][\w \t*&\n]*?\b(\w+)\(([^;{}]*)\)\s*(?:const\s*)?[;{]', re.M)
NO_PARAMETERS = re.compile(r'parameters of member (\S+) are not documented')
NO_RETURN = re.compile(r'return type of member (\S+) is not documented')


def doxygen_filter(root):
    """include/doxygen.py, which Doxygen runs for each file."""
    spec = importlib.util.spec_from_file_location('doxygen_filter', os.path.join(root, 'include', 'doxygen.py'))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def headers(root):
    return [path for path in files(root, 'include', 'port', ends=('.h', '.hpp'))
            if path.startswith('include/fathom/') or re.fullmatch(r'port/\w+/fathom_\w+\.h', path)]


def declarations(root):
    """{function: (path, line, number of parameters, first words of its comment)}. Of a class: without its class."""
    found = {}
    for path in headers(root):
        text = read(root, path)
        code = code_of(text)
        for match in (METHOD if 'namespace fathom' in code else FUNCTION).finditer(code):
            comment = '\n'.join(text.split('\n')[:code.count('\n', 0, match.start())]).rstrip()
            comment = comment[comment.rindex('/**'):] if comment.endswith('*/') and '/**' in comment else ''
            count = 0 if match[2].strip() in ('', 'void') else match[2].count(',') + 1
            words = re.sub(r'^[/*\s]*(?:@brief\s+)?', '', comment)
            found[match[1]] = path, code.count('\n', 0, match.start(1)) + 1, count, words
    return found


def warnings(root, said):
    """(path, line, text) of each warning of Doxygen that is a violation."""
    declared = declarations(root)
    lines = said.split('\n')
    for number, line in enumerate(lines):
        found = PLACE.fullmatch(line)
        if not found:
            if line and not line.startswith('  '):
                yield 'include/Doxyfile', 1, line
            continue
        path, at, text = found.groups()
        if text.endswith(':'):
            more = [part.strip() for part in lines[number + 1:number + 20]]
            text += ' ' + ', '.join(more[:more.index('')] if '' in more else more)
            text = re.split(r', \S+:\d+: ', text)[0]
        function = NO_PARAMETERS.match(text) or NO_RETURN.match(text)
        name = function and function[1].split('::')[-1]
        if name in declared:
            own, line_of, count, words = declared[name]
            if path.startswith('<'):  # Doxygen does not report the place
                path, at = own, line_of
            if NO_PARAMETERS.match(text) and count < 2 or NO_RETURN.match(text) and words.startswith('Returns '):
                continue
        yield os.path.relpath(path, root) if os.path.isabs(path) else path, int(at), text


def broken_links(folder):
    """(page, link) for links of the HTML pages that lead nowhere."""
    def page(name):
        with open(os.path.join(folder, name), encoding='utf-8') as file:
            return file.read()

    for name in sorted(os.listdir(folder)):
        if not re.fullmatch(r'(page_\w+|index)\.html', name):
            continue
        for target in re.findall(r'(?:href|src)="([^"]+)"', page(name)):
            there, _, anchor = target.partition('#')
            if ':' in target or not target:
                continue
            if not os.path.exists(os.path.join(folder, there or name)) or \
                    anchor and not re.search(rf'(?:id|name)="{re.escape(anchor)}"', page(there or name)):
                yield name, target


def bare_enumerators(root, folder):
    """(path, line, text) of each enumerator without a comment. Doxygen 1.9.4 does not report them."""
    for path in files(folder, '.', ends='.xml'):
        for enum in ElementTree.parse(os.path.join(folder, path)).iterfind('.//memberdef[@kind="enum"]'):
            for value in enum.iterfind('enumvalue'):
                if not any(''.join(value.find(kind).itertext()).strip()
                           for kind in ('briefdescription', 'detaileddescription')):
                    place = os.path.relpath(os.path.join(root, enum.find('location').get('file')), root)
                    name = value.findtext('name')
                    code = code_of(read(root, place))
                    yield place, code.count('\n', 0, re.search(rf'\b{name}\b', code).start()) + 1, \
                        f'Enumerator {name} is not documented.'


def own_rules(root):
    hide = doxygen_filter(root).without_private
    for path in headers(root):
        text = read(root, path)
        if not re.search(r'/\*\*(?:(?!\*/).)*@file\b(?:(?!\*/).)*@brief\b', text, re.S):
            yield path, 1, 'there is no comment with @file and @brief'
        left = re.search(r'/\* private:? \*/', hide(text))
        if left:
            yield path, text[:left.start()].count('\n') + 1, 'the mark does not stand alone on a line of a struct'


def violations(root):
    with tempfile.TemporaryDirectory() as work:
        done = subprocess.run(['doxygen', '-'], cwd=root, input=SETTINGS.format(work), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
        found = [*warnings(root, done.stdout), *own_rules(root)]
        found += bare_enumerators(root, os.path.join(work, 'xml'))
        html = os.path.join(work, 'html')
        if not os.path.exists(os.path.join(html, 'index.html')):
            found.append(('include/Doxyfile', 1, 'Doxygen made no index.html'))
            return found
        found += [(f'html/{page}', 1, f'links to {target}, which is not there') for page, target in broken_links(html)]
    return sorted(set(found))


def check(root):
    return [f'{path}:{line}: {text}' for path, line, text in violations(root)]


def count():
    found = Counter(path for path, _, _ in violations(ROOT))
    for path in headers(ROOT):
        found[path] += 0
    for path, number in sorted(found.items()):
        print(f'{number:4} {path}')
    print(f'{sum(found.values()):4} in {len(found)} files')
    return 1 if sum(found.values()) else 0


if __name__ == '__main__':
    if sys.argv[1:] == ['--count']:
        sys.exit(count())
    main(check)
