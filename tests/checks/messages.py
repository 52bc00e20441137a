#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The messages of the tool: what it prints on standard error, from the sources.

    messages.py            what breaks a rule below
    messages.py --list     every message: file, line, function, text

A message is what a function passes to a printer of messages: fprintf and fputs to stderr, a function that formats like
printf (reject), or a function that is passed stderr. The strings of the table of causes (diagnosis/) are messages too. One
call is one entry, so a message that is made of parts has several."""
import re
import sys

from common import ROOT, files, main, read

TOOL = 'examples/fathom/'
# Printers that format like printf: where the format stands among the arguments.
FORMATS = {'reject': 1, 'wrong': 1, 'commission_prompt': 1, 'session_reject': 2, 'port_fail': 2, 'broker_explain': 1}
FUNCTION = re.compile(r'^(static )?[a-z][\w *]*?[ *](\w+)\(([^;{}]*?)\)\n\{\n', re.M)
CALL = re.compile(r'\b(\w+)\(')
STRING = re.compile(r'"((?:\\.|[^"\\\n])*)"')
SILENT = re.compile(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
NUMBER = re.compile(r'PRI[duxX]\w+')

# Telegraphic words, and what to write. Help is not a message, and names in quotes stand for themselves.
WORDS = [
    (r'says? so|is said|is told|tells?|told', 'reports, prints'),
    (r'unasked', 'unsolicited, without requests'),
    (r'anew', 'again'),
    (r'besides', 'also'),
    (r'likewise', 'also'),
    (r'in turns', 'alternately'),
    (r'as from the factory', 'with factory settings'),
    (r'by itself|of its own', 'without requests, automatically'),
    (r'under way', 'in progress'),
    (r'for good', 'permanently'),
    (r'all the same', 'anyway'),
    (r'(some|any|no)(body|one)|something', 'the name of the subject'),
    (r'is away|is gone|has gone', 'does not respond, was unplugged'),
    (r'made out', 'recognised'),
    (r'in vain', 'without success'),
    (r'so many|so long|as long as that', 'a number'),
]
WRONG = [(re.compile(rf'\b(?:{word})\b'), better) for word, better in WORDS]
# A message that one call prints as a whole is a sentence, unless it ends with a text from elsewhere.
WHOLE = re.compile(r'^fathom: .*[\w)]\\n$')
FOREIGN = re.compile(r'%[\w.*]*s\\n$')
INTERNAL = re.compile(r'\b(FATHOM_(?!PORT\b)[A-Z]\w+|\w+_t|NULL|struct|stdin|stderr)\b')


def code_of(text):
    """The text with blanks for comments and for what stands in literals: every place stays where it is."""
    return SILENT.sub(lambda found: re.sub(r'[^\n]', ' ', found[0]), text)


def arguments(text, code, at):
    """The arguments of the call whose bracket is at `at`."""
    depth, begin, found = 0, at + 1, []
    for i in range(at, len(code)):
        depth += (code[i] in '([{') - (code[i] in ')]}')
        if depth == 0 or (depth == 1 and code[i] == ','):
            found.append(text[begin:i].strip())
            begin = i + 1
        if depth == 0:
            break
    return found


def words_of(text):
    """The strings of an argument, joined."""
    return ''.join(STRING.findall(NUMBER.sub('"d"', text)))


class Source:
    def __init__(self, path, text):
        self.path, self.text, self.code = path, text, code_of(text)
        self.functions = []  # (name, its streams, begin, end)
        self.own = set()  # names of static functions
        for found in FUNCTION.finditer(self.code):
            end = self.code.find('\n}\n', found.end())
            self.functions.append((found[2], re.findall(r'FILE \*(?:const )?(\w+)', found[3]), found.end(), end))
            if found[1]:
                self.own.add(found[2])

    def calls(self, begin, end):
        for found in CALL.finditer(self.code, begin, end):
            yield found[1], arguments(self.text, self.code, found.end() - 1), found.start()

    def name(self, function):
        """A static function is another one in another file."""
        return (self.path, function) if function in self.own else function

    def line(self, at):
        return self.text.count('\n', 0, at) + 1


def printers(sources):
    """Functions that are passed stderr, also by another one of them: their streams are messages."""
    known = set()
    while True:
        before = set(known)
        for source in sources:
            for name, streams, begin, end in source.functions:
                ours = {'stderr', *(streams if source.name(name) in known else ())}
                known |= {source.name(called) for called, parts, _ in source.calls(begin, end)
                          if ours & set(parts) and called not in ('fprintf', 'fputs', 'fputc', 'fflush', 'ferror')}
        if known == before:
            return known


def messages(root):
    """(path, line, function, text)"""
    sources = [Source(path, read(root, path)) for path in files(root, TOOL[:-1], ends='.c')]
    known = printers(sources)
    for source in sources:
        for name, streams, begin, end in source.functions:
            ours = {'stderr', *(streams if source.name(name) in known else ())}
            for called, parts, at in source.calls(begin, end):
                text = ''
                if called == 'fprintf' and ours & set(parts[:1]):
                    text = words_of(' '.join(parts[1:]))
                elif called == 'fputs' and ours & set(parts[1:]):
                    text = words_of(parts[0])
                elif called in FORMATS:
                    text = words_of(' '.join(parts[FORMATS[called]:]))
                if re.search('[a-z]', text):
                    yield source.path, source.line(at), name, text
        if source.path.startswith(TOOL + 'diagnosis/'):
            outside = [(0, source.functions[0][2] if source.functions else len(source.text))]
            for begin, end in outside:
                for found in STRING.finditer(source.text, begin, end):
                    if ' ' in found[1]:
                        yield source.path, source.line(found.start()), 'table', found[1]


def check(root):
    problems = []
    for path, line, _, text in messages(root):
        plain = re.sub(r"'[^']*'|`[^`]*`|--[\w-]+", '', text)
        problems += [f'{path}:{line}: {found[0]!r} in {text!r}; write {better}'
                     for wrong, better in WRONG for found in wrong.finditer(plain.lower())]
        if WHOLE.search(text) and not FOREIGN.search(text):
            problems.append(f'{path}:{line}: {text!r} ends without a full stop')
        problems += [f'{path}:{line}: {found[0]} is an internal name, in {text!r}' for found in INTERNAL.finditer(plain)]
    return problems


if __name__ == '__main__':
    if '--list' in sys.argv[1:]:
        for path, line, name, text in messages(ROOT):
            print(f'{path[len(TOOL):]}:{line}: {name}: {text}')
    else:
        main(check)
