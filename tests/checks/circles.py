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

A header that has no source of its name (X_internal.h, what stands in internal/, types) is counted by the first rule
only: what it declares is in the sources of its folder, and the second rule asks which of them define it."""
import os
import re

from common import TEST_PORTS, code_of, files, main, read

FOLDERS = ('include', 'src', 'port', 'examples', 'tests')
WITH_MODULES = ('include/', 'src/', 'port/', 'examples/', *(port + '/' for port in TEST_PORTS))
ENDS = ('.c', '.h', '.cpp', '.ino')

# Where circles are still there: how the paths of all their files begin, and why. What is mended is to be taken out.
KNOWN = {}

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"]', re.M)
WORD = re.compile(r'(?<![\w.])(?<!->)[A-Za-z_]\w*')
FUNCTION = re.compile(r'^(?!static\b|typedef\b)[A-Za-z_][\w \t*]*?\b(\w+)\s*\([^;{}]*\)\s*\{', re.M)
OBJECT = re.compile(r'^(?!static\b|typedef\b|extern\b)[A-Za-z_][\w \t*]*?\b(\w+)(?:\[[^\]\n]*\])*\s*(?:=|;)', re.M)


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


def check(root, only):
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
    problems, seen = [], set()
    for circle, words in found:
        places = [place for place in KNOWN if all(node.startswith(place) for node in circle)]
        seen.update(places[:1])
        if not places:
            problems.append(words)
    mended = [place for place in KNOWN if place not in seen]
    return problems + [f'{place}: no circle there any more; take it out of KNOWN' for place in mended]


FAULT = ('include/fathom/hal.h', None, '#include "fathom/engine/line.h"\n', 'a circle of includes')

if __name__ == '__main__':
    main(check, FAULT)
