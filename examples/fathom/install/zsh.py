# SPDX-License-Identifier: MIT
"""The completion of zsh, by its _arguments."""
from tool_help import short

FRAME = r'''#compdef fathom
# {header}

_fathom_port() {{
    local -a devices
    devices=({devices})
    (( $#devices )) && compadd "$@" -a devices
    _files "$@"
}}

_fathom_setting() {{
    case ${{line[1]%%[:@]*}} in
{settings}
    esac
}}

_fathom_value() {{
    case ${{line[1]%%[:@]*}}/$line[2] in
{values}
    esac
}}

_fathom() {{
    local curcontext=$curcontext state
    local -a line commands
    if (( CURRENT == 2 )); then
        commands=(
{commands}
        )
        _describe -t commands command commands
        compadd -- --help --version
        return
    fi
    shift words
    (( CURRENT-- ))
    case $words[1] in
{cases}
    esac
}}

_fathom "$@"
'''


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def words(names):
    """An action of _arguments, which puts options of its own behind compadd: one of these words."""
    return 'compadd -- ' + ' '.join(name.replace(':', '\\:') for name in names)


def action(option):
    if option.choices:
        return words(option.choices)
    if option.is_path:
        return '_fathom_port' if option.long == '--port' else '_files'
    return ' '


def specs(command, option):
    said = f'[{short(option.text)}]'
    value = option.value.split('[')[0] if option.value else ''
    for name in option.names:
        others = [other for other in option.names if other != name]
        begin = '*' if command.name == 'sim' else f'({" ".join(others)})' if others else ''
        if not option.value:
            yield quoted(f'{begin}{name}{said}')
        elif option.is_optional:
            yield quoted(f'{begin}{name}=-{said}::{value}:{action(option)}')
        else:
            yield quoted(f'{begin}{name}{"=" if name == option.long else "+"}{said}:{value}:{action(option)}')


def operands(command):
    if command.takes_files:
        yield quoted('*:FILE:_files')
    elif command.takes_settings:
        yield quoted(f'1:SENSOR:{words(command.sensors)}')
        yield quoted('2:SETTING:_fathom_setting')
        if command.takes_values:
            yield quoted('3:VALUE:_fathom_value')
    elif command.sensors:
        yield quoted(f'{"*" if command.takes_several else "1"}:SENSOR:{words(command.sensors)}')
    else:
        yield quoted('*: : ')  # words that it has no list of; options may follow them


def case(command):
    rows = [*(spec for option in command.options for spec in specs(command, option)), *operands(command)]
    return [f'    {command.name})', '        _arguments -S : \\',
            *(f'            {row} \\' for row in rows[:-1]), f'            {rows[-1]}', '        ;;']


def text(tool, header, devices):
    settings = [f'    {model}) compadd "$@" -- {" ".join(names)} ;;' for model, names in tool.settings.items()]
    values = [f'    {model}/{name}) compadd "$@" -- {" ".join(taken)} ;;'
              for model, names in tool.settings.items() for name, taken in names.items() if taken]
    commands = [f'            {quoted(command.name + ":" + command.summary)}' for command in tool.commands]
    return FRAME.format(header=header, devices=' '.join(f'{device}(N)' for device in devices),
                        settings='\n'.join(settings), values='\n'.join(values), commands='\n'.join(commands),
                        cases='\n'.join(line for command in tool.commands for line in case(command)))
