# SPDX-License-Identifier: MIT
"""Text of C seen as tokens: finding a piece of it whatever its white space, comments and line numbers are."""
import re

TOKEN = re.compile(
    r'(?P<skip>\s+|\\\n|//[^\n]*|/\*.*?\*/)'
    r'|(?P<name>[A-Za-z_]\w*)'
    r'|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
    r'|\.?\d(?:[eEpP][+-]|[\w.])*'
    r'|<<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|##|::|.', re.S)
DIRECTIVE = re.compile(r'^[ \t]*#(?:[^\n\\]|\\.)*', re.M | re.S)
KEYWORDS = frozenset('''auto bool break case char const continue default do double else enum extern false float
for goto if inline int long register restrict return short signed sizeof static struct switch true typedef union
unsigned void volatile while'''.split())


class NotThere(ValueError):
    """A text that is not, or not exactly once, where it should be."""


class Token:
    __slots__ = ('text', 'start', 'end', 'is_name')

    def __init__(self, found):
        self.text, self.start, self.end = found[0], found.start(), found.end()
        self.is_name = found['name'] is not None

    def __eq__(self, other):
        return self.text == other.text


def tokens(text):
    return [Token(found) for found in TOKEN.finditer(text) if found['skip'] is None]


def opening(all_tokens, at):
    """The index of the ( that the ) at this index closes, or -1."""
    depth = 0
    for i in range(at, -1, -1):
        depth += {')': 1, '(': -1}.get(all_tokens[i].text, 0)
        if depth == 0:
            return i
    return -1


def name_of(all_tokens, at):
    """The name of the function whose parameters end with the ) at this index.

    ISR(VECTOR) is called VECTOR, a method CLASS::METHOD."""
    first = opening(all_tokens, at)
    if first < 1 or not all_tokens[first - 1].is_name:
        return None
    name = all_tokens[first - 1].text
    if first > 2 and all_tokens[first - 2].text == '::':
        return f'{all_tokens[first - 3].text}::{name}'
    return all_tokens[first + 1].text if name == 'ISR' else name


def functions(text, all_tokens):
    """[(name, index of its first token, index behind its last one)]"""
    directives = [found.span() for found in DIRECTIVE.finditer(text)]
    seen = []  # indexes without the lines of the preprocessor
    for i, token in enumerate(all_tokens):
        while directives and directives[0][1] <= token.start:
            directives.pop(0)
        if not directives or token.start < directives[0][0]:
            seen.append(i)
    found, begin, name, depth = [], None, None, 0
    plain = [all_tokens[i] for i in seen]
    start = 0  # behind what ended before
    for i, token in enumerate(plain):
        if name is None:
            if token.text == '{' and i != 0 and plain[i - 1].text in (')', 'const', 'noexcept', 'override'):
                at = i - 1
                while plain[at].text != ')':
                    at -= 1
                name = name_of(plain, at)
                begin, depth = start, 1
            elif token.text in (';', '{', '}'):
                start = i + 1
        else:
            depth += {'{': 1, '}': -1}.get(token.text, 0)
            if depth == 0:
                found.append((name, seen[begin], seen[i] + 1))
                name, start = None, i + 1
    return found


def ranges(text, all_tokens, function):
    """Where in the tokens to look: in the function, or where no function is."""
    all_functions = functions(text, all_tokens)
    if function:
        found = [(first, end) for name, first, end in all_functions if name == function]
        if len(found) != 1:
            raise NotThere(f'the function {function} is there {len(found)} times')
        return found
    gaps, at = [], 0
    for _, first, end in all_functions:
        gaps.append((at, first))
        at = end
    return gaps + [(at, len(all_tokens))]


def is_local(within, i):
    """Whether the token may be a local variable's name by what is around it."""
    token = within[i]
    before = within[i - 1].text if i != 0 else ''
    after = within[i + 1].text if i + 1 != len(within) else ''
    return token.is_name and token.text[0].islower() and token.text not in KEYWORDS and \
        before not in ('.', '->') and after != '('


def locals_of(some_tokens):
    return {token.text for i, token in enumerate(some_tokens) if is_local(some_tokens, i)}


def match(old, within, at, missing):
    """{name that is missing: its new name} when the tokens at this index are the old ones, else None."""
    names = {}
    for i, token in enumerate(old):
        text = within[at + i].text
        if token.text in missing and is_local(old, i):
            if not is_local(within, at + i) or names.setdefault(token.text, text) != text:
                return None
        elif token.text != text:
            return None
    if len(set(names.values())) != len(names) or (locals_of(old) - missing) & set(names.values()):
        return None
    return names


def find(text, function, old):
    """(start, end, {old local name: new local name}) of the only place of a text.

    A name that the function does not have any more may stand for a local variable that was renamed."""
    all_tokens, wanted = tokens(text), tokens(old)
    if not wanted:
        raise NotThere('there is no old text')
    within = [all_tokens[first:end] for first, end in ranges(text, all_tokens, function)]
    missing = locals_of(wanted) - locals_of(within[0]) if function else set()
    found = []
    for part in within:
        for at in range(len(part) - len(wanted) + 1):
            names = match(wanted, part, at, missing)
            if names is not None:
                found.append((part[at].start, part[at + len(wanted) - 1].end, names))
    where = f'in {function}' if function else 'outside of functions'
    if not found:
        raise NotThere(f'{" ".join(old.split())!r} is gone {where}')
    if len(found) != 1:
        raise NotThere(f'{" ".join(old.split())!r} is ambiguous {where}: it is there {len(found)} times')
    return found[0]


def rename(text, names, only_locals=False):
    """The text with other names; what stands in strings and comments stays."""
    all_tokens = tokens(text)
    for i in reversed(range(len(all_tokens))):
        token = all_tokens[i]
        if token.is_name and token.text in names and (not only_locals or is_local(all_tokens, i)):
            text = text[:token.start] + names[token.text] + text[token.end:]
    return text


def replace(text, edits):
    """The text with each (function, old, new) of the edits carried out; all are found in the text as it is."""
    spans = []
    for function, old, new in edits:
        start, end, names = find(text, function, old)
        spans.append((start, end, rename(new, names, True)))
    spans.sort()
    for (_, end, _), (start, _, _) in zip(spans, spans[1:]):
        if start < end:
            raise NotThere('two edits overlap')
    for start, end, new in reversed(spans):
        text = text[:start] + new + text[end:]
    return text
