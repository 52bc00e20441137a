# SPDX-License-Identifier: MIT
"""The pages of man, in the macros of man(7): fathom(1), and fathom-COMMAND(1) for each command."""
import re

from tool_help import Item, Option

FILES = [
    ('/dev/ttyUSB0', 'A serial port. It belongs to the group dialout on Debian.'),
    ('/dev/serial/by-id/', 'The same ports by the names of their adapters, which stay in another socket.'),
    ('/dev/gpiochip0', 'The lines of a board.'),
]
SEE_ALSO = ['mbpoll(1)', 'gpioinfo(1)']


def plain(text):
    """Text of a paragraph or a row. What stands between ` is bold, as a command and an option are."""
    text = text.replace('\\', '\\e').replace("'", '\\(aq').replace('~', '\\(ti').replace('^', '\\(ha')
    text = re.sub(r'`([^`]+)`', r'\\fB\1\\fR', text)
    text = re.sub(r'(?<![\w-])(--[\w-]*\w)', r'\\fB\1\\fR', text)
    text = re.sub(r'(?<![\w-])-(?=[\dA-Za-z-])|(?<=[\\B-])-(?=[\w-])', r'\\-', text)  # of numbers and options
    return re.sub(r'(?m)^\.', r'\\&.', text)


def literal(text):
    """What is typed: each - is one."""
    return text.replace('\\', '\\e').replace('-', '\\-').replace("'", '\\(aq').replace('~', '\\(ti')


def lines_of(text):
    """A sentence a line, as man(7) wants it; no line of the source is over 80 bytes where a blank allows it."""
    for sentence in re.split(r'(?<=[a-z)\d][.:;?!]) (?=[A-Z])', text):
        line = ''
        for word in sentence.split(' '):
            if line and len(line) + len(word) > 78:
                yield line
                line = ''
            line = f'{line} {word}' if line else word
        yield line


def filled(text):
    for line in lines_of(plain(text)):
        yield '\\&' + line if line.startswith(('.', "'")) else line


def row(item, tag=None):
    yield '.TP'
    yield '.B ' + (tag or literal(item.tag))
    if item.text:
        yield from filled(item.text)
    elif not item.below:
        yield '\\&'
    if item.below:
        yield '.RS'
        for below in item.below:
            yield from row(below)
        yield '.RE'


def tag_of(option):
    match = re.match(r'(--[\w-]+)(.*)$', option.tag)
    name, rest = match[1], match[2]
    return literal(name) + (f'\\fR{literal(rest)}' if rest else '')


def blocks(found):
    """Paragraphs and rows, in their order."""
    for block in found:
        if isinstance(block, Option):
            yield from row(block, tag_of(block))
        elif isinstance(block, Item):
            yield from row(block)
        else:
            yield '.PP'
            yield from filled(block)


def section(name, lines):
    lines = list(lines)
    while lines and lines[0] == '.PP':
        lines.pop(0)
    return [f'.SH {name}', *lines] if lines else []


def synopsis(rows):
    for number, item in enumerate(rows):
        if number:
            yield '.br'
        words = item.tag.split(' ')
        yield f'.B {literal(" ".join(words[:2]))}'
        yield from lines_of(literal(' '.join(words[2:]))) if words[2:] else ()


def examples(rows):
    for item in rows:
        yield '.TP'
        yield '.B ' + literal(item.tag)
        if item.text:
            text = item.text
            yield from [f'.B {literal(text)}'] if re.match(r'(fathom|mbpoll) ', text) else filled(text)
        else:
            yield '\\&'


def see_also(names):
    names = sorted(set(names))
    for name in names:
        title, number = name[:-1].split('(')
        yield f'.BR {literal(title)} ({number})' + (' ,' if name != names[-1] else '')


def page(title, version, date, name, sections):
    lines = [f'.\\" Made from the help of fathom {version}.',
             f'.TH {title.upper()} 1 {date} "fathom {version}" "User Commands"',
             '.nh', '.ad l', '.SH NAME', f'{literal(title)} \\- {plain(name)}']
    for one in sections:
        lines += one
    return '\n'.join(lines) + '\n'


def command_page(tool, command, version, date):
    said = command.help
    first, *rest = said.before
    others = [f'fathom-{other.name}(1)' for other in tool.commands
              if other is not command and re.search(rf'fathom {other.name}\b', tool.says(command.name, '--help'))]
    more = [f'{row.tag}: {row.text}' for row in said.usage if row.text]
    return page(f'fathom-{command.name}', version, date, command.summary, [
        section('SYNOPSIS', synopsis(said.usage)),
        section('DESCRIPTION', blocks([f'`fathom {command.name}`{first[len("fathom " + command.name):]}',
                                       *(f'`{line}'.replace(': ', '`: ', 1) for line in more), *rest])),
        section('OPTIONS', blocks(said.options)),
        section('NOTES', blocks(said.after)),
        section('EXIT STATUS', filled(said.status) if said.status else []),
        section('EXAMPLES', examples(said.examples)),
        section('SEE ALSO', see_also(['fathom(1)', *others]))])


def main_page(tool, version, date):
    said = tool.help
    intro, rest = said.blocks[0], said.blocks[1:]
    purpose = intro[len('fathom '):].rstrip('.')
    options = [item for item in rest if isinstance(item, Item) and item.tag.startswith('fathom ')]
    commands = [Item(f'fathom-{command.name}(1)', command.summary) for command in tool.commands]
    return page('fathom', version, date, purpose, [
        section('SYNOPSIS', synopsis([*said.usage, *(Item(item.tag, '') for item in options)])),
        section('DESCRIPTION', blocks([intro, *options, *(block for block in rest if isinstance(block, str))])),
        section('COMMANDS', blocks(commands)),
        section('EXIT STATUS', filled(said.status) if said.status else []),
        section('FILES', blocks([Item(*file) for file in FILES])),
        section('EXAMPLES', [*filled(said.examples_title), *examples(said.examples)]),
        section('SEE ALSO', see_also([*SEE_ALSO, *(f'fathom-{command.name}(1)' for command in tool.commands)]))])


def pages(tool, version, date):
    """{file name: text}"""
    made = {'fathom.1': main_page(tool, version, date)}
    made.update((f'fathom-{command.name}.1', command_page(tool, command, version, date)) for command in tool.commands)
    return made
