# SPDX-License-Identifier: MIT
"""Finds pieces of C text by their tokens, so that white space and comments do not matter."""
import re

TOKEN = re.compile(
    r'(?P<skip>\s+|\\\n|//[^\n]*|/\*.*?\*/)'
    r'|(?P<name>[A-Za-z_]\w*)'
    r'|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
    r'|\.?\d(?:[eEpP][+-]|[\w.])*'
    r'|<<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|##|::|.', re.S)
DIRECTIVE = re.compile(r'^[ \t]*#(?:[^\n\\]|\\.)*', re.M | re.S)


class NotThere(ValueError):
    """The text does not occur exactly once in its place."""


class Token:
    __slots__ = ('text', 'start', 'end', 'is_name')

    def __init__(self, found):
        self.text, self.start, self.end = found[0], found.start(), found.end()
        self.is_name = found['name'] is not None


def tokens(text):
    return [Token(found) for found in TOKEN.finditer(text) if found['skip'] is None]


def opening(all_tokens, at):
    """Returns the index of the ( that the ) at index `at` closes, or -1."""
    depth = 0
    for i in range(at, -1, -1):
        depth += {')': 1, '(': -1}.get(all_tokens[i].text, 0)
        if depth == 0:
            return i
    return -1


def name_of(all_tokens, at):
    """Returns the name of the function whose parameter list ends with the ) at index `at`."""
    first = opening(all_tokens, at)
    return all_tokens[first - 1].text if first > 0 and all_tokens[first - 1].is_name else None


def functions(text, all_tokens):
    """Returns [(name, index of the first token, index behind the last token)] of the functions that `text` defines."""
    directives = [found.span() for found in DIRECTIVE.finditer(text)]
    seen = []  # the indexes of the tokens that belong to no line of the preprocessor
    for i, token in enumerate(all_tokens):
        while directives and directives[0][1] <= token.start:
            directives.pop(0)
        if not directives or token.start < directives[0][0]:
            seen.append(i)
    found, begin, name, depth = [], None, None, 0
    plain = [all_tokens[i] for i in seen]
    start = 0  # the index behind the previous definition or declaration
    for i, token in enumerate(plain):
        if name is None:
            if token.text == '{' and i != 0 and plain[i - 1].text == ')':
                name = name_of(plain, i - 1)
                begin, depth = start, 1
            elif token.text in (';', '{', '}'):
                start = i + 1
        else:
            depth += {'{': 1, '}': -1}.get(token.text, 0)
            if depth == 0:
                found.append((name, seen[begin], seen[i] + 1))
                name, start = None, i + 1
    return found


def find(text, function, old):
    """Returns (start, end) of the tokens of `old` in `function`, where they must occur exactly once. If `function` is
    '', the whole text is searched."""
    all_tokens, wanted = tokens(text), [token.text for token in tokens(old)]
    first, end = 0, len(all_tokens)
    if function:
        places = [place for name, *place in functions(text, all_tokens) if name == function]
        if len(places) != 1:
            raise NotThere(f'the function {function} is defined {len(places)} times')
        first, end = places[0]
    words = [token.text for token in all_tokens]
    found = [at for at in range(first, end - len(wanted) + 1) if words[at:at + len(wanted)] == wanted]
    if len(found) != 1 or not wanted:
        raise NotThere(f'{" ".join(wanted)!r} occurs {len(found)} times in {function or "the text"}, not once')
    return all_tokens[found[0]].start, all_tokens[found[0] + len(wanted) - 1].end


