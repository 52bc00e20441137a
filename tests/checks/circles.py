#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No two files lean on each other, directly or round a circle.

 1. Files: no file includes itself through others, in any folder.
 2. Modules of the library, the ports and the examples: X.c and X.h are one module (include/fathom/.../X.h and
    src/.../X.c too). It uses another module when it includes that one's header, unless for what its own source
    defines, or when its source names what the other's source defines and a header that both include declares. No
    module uses itself through others. A source with main() is a program, and nothing uses one, though start-up code
    names main and interrupt handlers. What several sources define is a hook, of which each program links one
    (start_end of the boards): to name it uses none of them.
 3. Calls in src/ and port/: no module refers to itself through the functions and objects of others. This rule reads the
    relocations of the object files, so it sees each function that is called or whose address is taken. An inline
    function belongs to its header. The Arduino port is one file of C++, which this rule does not compile.

In the third rule a header that has no source of its name (what stands in internal/, types) is a module, and
X_internal.h belongs to X. Neither counts in the second rule: what they declare is in the sources of their folder."""
import os
import re
import tempfile
from concurrent.futures import ThreadPoolExecutor

from common import LIBMODBUS, TEST_PORTS, code_of, files, main, read, run

FOLDERS = ('include', 'src', 'port', 'examples', 'tests')
WITH_MODULES = ('include/', 'src/', 'port/', 'examples/', *(port + '/' for port in TEST_PORTS))
ENDS = ('.c', '.h', '.cpp', '.ino')

# Where circles are still there: how the paths of all their files begin, and why. What is mended is to be taken out.
KNOWN = {}

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"]', re.M)
WORD = re.compile(r'(?<![\w.])(?<!->)[A-Za-z_]\w*')
FUNCTION = re.compile(r'^(?!static\b|typedef\b)[A-Za-z_][\w \t*]*?\b(\w+)\s*\([^;{}]*\)\s*\{', re.M)
OBJECT = re.compile(r'^(?!static\b|typedef\b|extern\b)[A-Za-z_][\w \t*]*?\b(\w+)(?:\[[^\]\n]*\])*\s*(?:=|;)', re.M)


INLINE = re.compile(r'^static inline [\w \t*]*?\b(\w+)\s*\(', re.M)

COMPILED = ('src', 'port')
PREFIX = {'avr': 'avr-', 'rp2040': 'arm-none-eabi-', 'stm32f4': 'arm-none-eabi-'}
FLAGS = {'': [], 'avr-': ['-mmcu=atmega328p', '-DF_CPU=16000000UL'], 'arm-none-eabi-': ['-mcpu=cortex-m3', '-mthumb']}
# Nothing is inlined or left out, and each function and object has a section of its own.
COMPILE = ['-O0', '-w', '-std=c99', '-fkeep-inline-functions', '-ffunction-sections', '-fdata-sections', '-Iinclude',
           LIBMODBUS]
SECTION = re.compile(r'^\.(?:text|rodata|data\.rel\.ro(?:\.local)?|data\.rel(?:\.local)?|data|bss)\.')


def resolve(paths, source, bracket, name):
    """The file of the tree that an #include in `source` means, or None."""
    here = os.path.dirname(source)
    part = source.split('/')
    places = [here, 'include', 'port', 'examples', 'src', 'tests', 'tests/support',
              *('/'.join(part[:end]) for end in range(2, len(part)))]
    for place in places:
        path = os.path.normpath(os.path.join(place, name))
        if path in paths:
            return path
    # What a build file adds to the path: clear when only one file of the tree has that name.
    found = [path for path in paths if path.endswith('/' + name)] if bracket == '"' else []
    return found[0] if len(found) == 1 else None


def circles(graph):
    """The sets of nodes that reach each other, each as a sorted list (Tarjan, without recursion)."""
    index, low, stack, found = {}, {}, [], []
    for root in sorted(graph):
        if root in index:
            continue
        index[root] = low[root] = len(index)
        stack.append(root)
        walk = [(root, iter(sorted(graph[root])))]
        while walk:
            node, nexts = walk[-1]
            for other in nexts:
                if other not in index:
                    index[other] = low[other] = len(index)
                    stack.append(other)
                    walk.append((other, iter(sorted(graph[other]))))
                    break
                if other in stack:
                    low[node] = min(low[node], index[other])
            else:
                walk.pop()
                if walk:
                    low[walk[-1][0]] = min(low[walk[-1][0]], low[node])
                if low[node] == index[node]:
                    at = stack.index(node)
                    if len(stack) - at > 1 or node in graph[node]:
                        found.append(sorted(stack[at:]))
                    del stack[at:]
    return found


def one_way_round(graph, circle):
    """A shortest way from the circle's first node back to it."""
    first = circle[0]
    ways = [[first]]
    for way in ways:
        for other in sorted(graph[way[-1]]):
            if other == first:
                return [*way, first]
            if other in circle and not any(other in known for known in ways):
                ways.append([*way, other])
    return circle


def module_of(path):
    stem = os.path.splitext(path)[0]
    return re.sub(r'^include/fathom/', 'src/', stem)


def reach(graph, start):
    """All that a file includes, itself with it."""
    seen, left = {start}, [start]
    while left:
        for other in graph[left.pop()] - seen:
            seen.add(other)
            left.append(other)
    return seen


def uses(paths, code, includes):
    """({module: modules that it uses}, {(module, other): why})"""
    paths = [path for path in paths if path.startswith(WITH_MODULES)]
    sources = [path for path in paths if not path.endswith('.h')]
    modules = {module_of(path) for path in sources}
    headers = {path: {other for other in reach(includes, path) if other.endswith('.h')} for path in sources}
    words = {path: set(WORD.findall(code[path])) for path in paths}
    defined = {}
    for path in sources:
        if re.search(r'^int main\(', code[path], re.M):
            continue
        for name in FUNCTION.findall(code[path]) + OBJECT.findall(code[path]):
            defined.setdefault(name, set()).add(path)
    graph = {module: set() for module in modules}
    why = {}

    def add(path, other, reason):
        module, used = module_of(path), module_of(other)
        if module in modules and used in modules and module != used:
            graph[module].add(used)
            why.setdefault((module, used), reason)

    for path in paths:
        own = {name for name in words[path] if path in defined.get(name, ())}
        for other in includes[path]:
            if not own & words.get(other, set()):
                add(path, other, f'{path} includes {other}')
    for path in sources:
        for name in sorted(words[path] & set(defined)):
            other, *others = sorted(defined[name])
            shared = headers[path] & headers[other] & set(paths)
            if not others and any(name in words[header] for header in shared):
                add(path, other, f'{path} names {name}')
    return graph, why


def references(root, path, work):
    """(names with external linkage, [(name of the function or object that refers, name)], what the compiler printed)"""
    _, port, *_ = path.split('/')
    prefix = PREFIX.get(port, '') if path.startswith('port/') else ''
    include = ['-Iport', f'-Iport/{port}', '-Iport/serial', '-Iport/posix'] if path.startswith('port/') else []
    target = os.path.join(work, re.sub(r'\W', '_', path) + '.o')
    good, said = run([prefix + 'gcc', *FLAGS[prefix], *COMPILE, *include, '-c', path, '-o', target], root)
    if not good:
        return set(), [], said
    _, symbols = run([prefix + 'nm', '--defined-only', '--extern-only', target], root)
    _, relocations = run([prefix + 'objdump', '-r', target], root)
    found, user = [], None
    for line in relocations.split('\n'):
        section = re.match(r'RELOCATION RECORDS FOR \[(.*)\]:', line)
        if section:
            user = SECTION.sub('', section[1]) if SECTION.match(section[1]) else None
        elif user and len(line.split()) == 3:
            found.append((user, SECTION.sub('', re.sub(r'[+-]0x[0-9a-f]+$', '', line.split()[2]))))
    return {line.split()[-1] for line in symbols.split('\n') if line}, found, ''


def compiled(root):
    """{source of src/ and port/: what references() returns for it}"""
    sources = files(root, *COMPILED, ends='.c')
    with tempfile.TemporaryDirectory() as work, ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(sources, pool.map(lambda path: references(root, path, work), sources)))


def calls(root, code):
    """({module: modules that it uses}, {(module, other): ['user of FILE refers to name of FILE']}, problems)"""
    objects = compiled(root)
    places = {}
    for path in (path for path in code if path.endswith('.h') and path.startswith(('include/', 'src/', 'port/'))):
        for name in INLINE.findall(code[path]):
            places.setdefault(name, set()).add(path)
    inlined = set(places)
    for path, (defined, _, _) in objects.items():
        for name in defined:
            places.setdefault(name, set()).add(path)
    graph, why = {}, {}
    for path, (_, found, _) in objects.items():
        for user, name in found:
            owner = min(places[user]) if user in inlined and len(places[user]) == 1 else path
            if len(places.get(name, ())) != 1:  # a static name, the compiler's, or a hook
                continue
            other = min(places[name])
            # What X_internal.h defines belongs to X.
            module, used = (re.sub('_internal$', '', module_of(file)) for file in (owner, other))
            if module != used:
                graph.setdefault(module, set()).add(used)
                graph.setdefault(used, set())
                why.setdefault((module, used), set()).add(f'{user} of {owner} refers to {name} of {other}')
    return graph, why, [f'{path}: does not compile:\n{said}' for path, (_, _, said) in objects.items() if said]


def check(root):
    paths = files(root, *FOLDERS, ends=ENDS)
    text = {path: read(root, path) for path in paths}
    code = {path: code_of(text[path]) for path in paths}
    known = set(paths)
    includes = {path: {resolve(known, path, *found) for found in INCLUDE.findall(text[path])} - {None}
                for path in paths}
    found = []
    for circle in circles(includes):
        found.append((circle, 'a circle of includes: ' + ' -> '.join(one_way_round(includes, circle))))
    graph, why = uses(paths, code, includes)
    for circle in circles(graph):
        way = one_way_round(graph, circle)
        reasons = '; '.join(why[step] for step in zip(way, way[1:]))
        found.append((circle, f'a circle of {len(circle)} modules: {" ".join(circle)}: {reasons}'))
    graph, why, problems = calls(root, code)
    for circle in circles(graph):
        steps = sorted(reason for step, reasons in why.items() if set(step) <= set(circle) for reason in reasons)
        found.append((circle, f'a circle of calls between {" ".join(circle)}:\n    ' + '\n    '.join(steps)))
    seen = set()
    for circle, words in found:
        places = [place for place in KNOWN if all(node.startswith(place) for node in circle)]
        seen.update(places[:1])
        if not places:
            problems.append(words)
    mended = [place for place in KNOWN if place not in seen]
    return problems + [f'{place}: no circle there any more; take it out of KNOWN' for place in mended]


if __name__ == '__main__':
    main(check)
