#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The layers: the folder is the layer, and arrows point down only. Also: a .c beside every .h of the library, and files
of a size that one sitting reads."""
import os
import re

from common import files, main, read

# From the bottom up, in include/fathom/ and in src/ alike. A file may include files of its own folder and of the folders
# before it; '' is the words that all share. No file includes fathom.h. Headers that only other headers need stand in a
# folder internal/ of their layer.
LAYERS = ('', 'codec', 'engine', 'processing', 'sensor', 'models')
MAP = 'include/fathom/fathom.h'
COMMON = 'src/common.h'  # what the sources of engine/ and sensor/ share
# src/models/ has tables. All its sources are those of one header, and need no driver.
MODELS = 'include/fathom/models.h'
MODELS_NEED = {MODELS, 'include/fathom/sample.h', 'include/fathom/sensor/model_facts.h',
               'include/fathom/sensor/factory_line.h'}
# The same for the tool. commands/ stands on top: a file or a folder for each command, which includes no other command.
TOOL = ('output', 'ports', 'sensors', 'diagnosis', 'reading', 'device', 'mqtt', 'cli', 'commands')
TOOL_FOLDER = 'examples/fathom/'
# Declares the commands and the topics of the help.
ANYWHERE = (TOOL_FOLDER + 'commands/commands.h',)

# Arrows that still point up. Each has to go; none may be added.
UPWARDS = set()

STANDARD = {'stdbool.h', 'stddef.h', 'stdint.h'}
MAX_LINES = 400
# path: lines, with the reason beside it
LONGER = {'include/fathom/engine/line.h': 680}  # the manual of the line: 13 rules, and each member with its range

# Headers without a source of their own name, and why.
# A formula; types and constants, whose functions line.h and the clients have.
WITHOUT_SOURCE = ('include/fathom/engine/silence.h', 'include/fathom/engine/modbus.h',
                  'include/fathom/engine/transaction.h', 'include/fathom/sensor/model_facts.h')

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)


def room(path):
    """The folder of a file of the library; None: it stands where none may."""
    if path == MODELS:
        return 'models'
    found = re.fullmatch(r'(?:include/fathom/(?:(\w+)/(?:internal/)?)?|src/(?:(\w+)/)?)\w+\.[ch]', path)
    layer = found and (found[1] or found[2] or '')
    return layer if layer in LAYERS else None


def stem(path):
    """The layer and the name of a file, which its header and its sources share: engine/line."""
    return re.sub(r'^(include/fathom|src)/|internal/|\.[ch]$', '', path)


def includes(text):
    return INCLUDE.findall(text)


def check_library(path, text, headers):
    here = room(path)
    for bracket, target in includes(text):
        if bracket == '<':
            if target not in STANDARD:
                yield f'{path}: includes <{target}>; only {", ".join(sorted(STANDARD))} are there everywhere'
            continue
        private = os.path.normpath(os.path.join(os.path.dirname(path), target))
        if path.startswith('src/') and (private.endswith('_internal.h') and room(private) == here
                                        or private == COMMON and here != 'codec'):
            continue
        public = 'include/' + target
        if public not in headers:
            yield f'{path}: includes "{target}", which is no public header of the library'
        elif public == path:
            yield f'{path}: includes itself'
        elif room(path) == 'models' and public not in MODELS_NEED:
            yield f'{path}: includes {target}; a table of models needs facts and line settings'
        elif path != MAP and (public == MAP or LAYERS.index(room(public)) > LAYERS.index(here)):
            yield f'{path}: an arrow that points up, to {target}'


def check_tool(path, text, tool):
    """path: of a source or header of the tool, whose files are `tool`."""
    folder = os.path.dirname(path[len(TOOL_FOLDER):])
    for _, target in includes(text):
        if TOOL_FOLDER + target not in tool or TOOL_FOLDER + target in ANYWHERE or not folder:
            continue
        module, other = folder.split('/')[0], target.split('/')[0]
        if TOOL.index(other) < TOOL.index(module) or other == module != 'commands' or \
                os.path.dirname(target) == folder != 'commands':
            continue
        if (path[len(TOOL_FOLDER):], target) not in UPWARDS:
            yield f'{path}: {folder}/ may not include {target}'


# What differs between sensors stands in sensors/: others ask for facts in the rows of models and modes.
SENSORS = 'sensors/'
PARTICULAR = re.compile(
    r'\bFATHOM_(?:A16|A05|HPS167S)(?:_\w+)?\b|\b(?:fathom_)?(?:a16|a05|hps167s)_\w+ *\('
    r'|"fathom/sensor/(?!internal/)|"fathom/codec/hps167s|"sensors/(?:driver|dyp|a16|a05|hps167s)\.h"'
    r'|\bstrn?cmp\([^;]*"(?:a16|a05|hps167s|auto|modbus|dyp|controlled|pwm|switch|relay)"'
    r'|->(?:id|name) *[!=]= *(?:"|FATHOM_)')
# path: what it may say of one sensor, with the reason beside it
MAY_SAY = {'ports/listener.c': 'the frames of the two that send automatically'}  # codec, not driver


def check_particular(path, text):
    """path: of a source or header of the tool, below examples/fathom/."""
    if path.startswith(SENSORS) or path in MAY_SAY:
        return
    for number, line in enumerate(text.splitlines(), 1):
        found = PARTICULAR.search(line)
        if found:
            yield (f'{TOOL_FOLDER}{path}:{number}: {found[0].strip()}: asks which sensor it is; '
                   f'make it a fact of a row in {SENSORS}models.c')


def check(root):
    problems = []
    headers, sources = files(root, 'include', ends='.h'), files(root, 'src')
    for path in headers + sources:
        if room(path) is None or path.endswith('.h') and path.startswith('src/') and \
                path != COMMON and not path.endswith('_internal.h'):
            problems.append(f'{path}: stands where no file of the library may')
            continue
        text = read(root, path)
        problems += check_library(path, text, headers)
        if text.count('\n') > LONGER.get(path, MAX_LINES):
            problems.append(f'{path}: more than {MAX_LINES} lines: is there a second subject in it?')
        if path.startswith('src/') and path.endswith('.c'):
            # Further sources of X.h are X_SOMETHING.c.
            names = [header for header in headers
                     if stem(header) == stem(path) or stem(path).startswith(stem(header) + '_')]
            names = [MODELS] if room(path) == 'models' else names
            if not names:
                folder = os.path.dirname('include/fathom/' + path[4:])
                problems.append(f'{path}: there is no header of its name in {folder}')
            elif includes(text)[:1] != [('"', max(names, key=len)[8:])]:
                problems.append(f'{path}: its own header comes first, which proves that it is complete')
        elif path in headers and path != MODELS and room(path) and f'src/{stem(path)}.c' not in sources and \
                path not in WITHOUT_SOURCE:
            problems.append(f'{path}: there is no src/{path[15:-2]}.c')
    tool = files(root, 'examples/fathom')
    for path in tool:
        problems += check_tool(path, read(root, path), tool)
        if path.endswith(('.c', '.h')):
            problems += check_particular(path[len(TOOL_FOLDER):], read(root, path))
    return problems


if __name__ == '__main__':
    main(check)
