# SPDX-License-Identifier: MIT
"""The completion of fish."""
from tool_help import short

FRAME = r'''# {header}

function __fathom_command
    set -l words (commandline -opc)
    test (count $words) -ge 2; and test "$words[2]" = $argv[1]
end

# Prints the words behind the command that are neither options nor their values, a line each.
function __fathom_operands
    set -l words (commandline -opc)
    set -l is_value no
    for word in $words[3..-1]
        if test $is_value = yes
            set is_value no
        else if contains -- $word {valued}
            set is_value yes
        else if not string match -q -- '-*' $word
            echo $word
        end
    end
end

function __fathom_operand # COMMAND COUNT: so many stand there already
    __fathom_command $argv[1]; and test (count (__fathom_operands)) -eq $argv[2]
end

function __fathom_model # COMMAND COUNT MODEL [SETTING]: and what they are
    __fathom_operand $argv[1] $argv[2]; or return 1
    set -l operands (__fathom_operands)
    string match -q -r -- "^$argv[3](\$|[:@])" $operands[1]; or return 1
    test (count $argv) -lt 4; or test "$operands[2]" = $argv[4]
end

function __fathom_ports
    for device in {devices}
        echo $device
    end
    __fish_complete_path (commandline -ct)
end

complete -c fathom -f
complete -c fathom -n 'test (count (commandline -opc)) -eq 1' -l help -d 'prints the commands'
complete -c fathom -n 'test (count (commandline -opc)) -eq 1' -l version -d 'prints the version'
{rows}
'''


def quoted(text):
    return "'" + text.replace('\\', '\\\\').replace("'", "\\'") + "'"


def option_row(command, option):
    row = f'complete -c fathom -n {quoted("__fathom_command " + command.name)} -l {option.long[2:]}'
    if option.short:
        row += f' -s {option.short[1:]}'
    if option.choices:
        row += f' -x -a {quoted(" ".join(option.choices))}'
    elif option.is_path:
        row += " -x -a '(__fathom_ports)'" if option.long == '--port' else ' -r -F'
    elif option.value and not option.is_optional:
        row += ' -x'
    return f'{row} -d {quoted(short(option.text))}'


def operand_rows(tool, command):
    when = f'complete -c fathom -n {quoted("__fathom_command " + command.name)}'
    if command.takes_files:
        yield f'{when} -F'
    elif command.takes_settings:
        yield (f'complete -c fathom -n {quoted(f"__fathom_operand {command.name} 0")} '
               f'-a {quoted(" ".join(command.sensors))}')
        for model, names in tool.settings.items():
            yield (f'complete -c fathom -n {quoted(f"__fathom_model {command.name} 1 {model}")} '
                   f'-a {quoted(" ".join(names))}')
            for name, words in names.items():
                if command.takes_values and words:
                    yield (f'complete -c fathom -n {quoted(f"__fathom_model {command.name} 2 {model} {name}")} '
                           f'-a {quoted(" ".join(words))}')
    elif command.sensors:
        yield f'{when} -a {quoted(" ".join(command.sensors))}'


def text(tool, header, devices):
    rows, valued = [], []
    for command in tool.commands:
        rows.append(f"complete -c fathom -n 'test (count (commandline -opc)) -eq 1' -a {command.name} "
                    f'-d {quoted(command.summary)}')
        rows += [option_row(command, option) for option in command.options]
        rows += operand_rows(tool, command)
        valued += [name for option in command.options if option.value and not option.is_optional
                   for name in option.names if name not in valued]
    return FRAME.format(header=header, devices=' '.join(devices), valued=' '.join(valued), rows='\n'.join(rows))
