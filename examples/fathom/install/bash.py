# SPDX-License-Identifier: MIT
"""The completion of bash, which bash-completion loads."""

FRAME = r'''# {header}
_fathom() {{
    local cur prev words cword split
    _init_completion -s -n : || return
    if ((cword == 1)); then
        COMPREPLY=($(compgen -W '{commands} --help --version' -- "$cur"))
        return
    fi

    # options: all; valued: those whose value is the next word; takes: words, or port, file or nothing
    local options= valued= takes= sensors= settings= operands=()
    case ${{words[1]}} in
{cases}
    *) return ;;
    esac

    local at
    for ((at = 2; at < cword; at++)); do
        case " $valued " in *" ${{words[at]}} "*) ((at++)); continue ;; esac
        [[ ${{words[at]}} == -* ]] || operands+=("${{words[at]}}")
    done

    local words_of=
    if [[ $split == true || " $valued " == *" $prev "* ]]; then
        case $takes in
        port)
            local device
            for device in {devices}; do
                [[ -e $device && $device == "$cur"* ]] && COMPREPLY+=("$device")
            done
            _filedir
            return
            ;;
        file) _filedir; return ;;
        *) words_of=$takes ;;
        esac
    elif [[ $cur == -* ]]; then
        words_of=$options
    elif [[ $settings == files ]]; then
        _filedir
        return
    elif [[ -z $settings || ${{#operands[@]}} -eq 0 ]]; then
        words_of=$sensors
    elif ((${{#operands[@]}} == 1)); then
        case ${{operands[0]}} in
{settings}
        esac
    elif [[ $settings == values ]] && ((${{#operands[@]}} == 2)); then
        case ${{operands[0]%%[:@]*}}/${{operands[1]}} in
{values}
        esac
    fi
    COMPREPLY=($(compgen -W "$words_of" -- "$cur"))
    [[ ${{COMPREPLY-}} == *= ]] && compopt -o nospace
    __ltrim_colon_completions "$cur"
}} &&
    complete -F _fathom fathom
'''


def takes(option):
    if option.choices:
        return ' '.join(option.choices)
    return ('port' if option.long == '--port' else 'file') if option.is_path else ''


def case(command):
    names = [name for option in command.options for name in option.names]
    valued = [name for option in command.options if option.value and not option.is_optional for name in option.names]
    settings = 'files' if command.takes_files else 'values' if command.takes_values else \
        'settings' if command.takes_settings else ''
    lines = [f'    {command.name})', f"        options='{' '.join(names)}'", f"        valued='{' '.join(valued)}'"]
    if command.sensors:
        lines.append(f"        sensors='{' '.join(command.sensors)}'")
    if settings:
        lines.append(f'        settings={settings}')
    rows = [f"        {' | '.join(option.names)}) takes='{takes(option)}' ;;"
            for option in command.options if takes(option)]
    lines += ['        case $prev in', *rows, '        esac', '        ;;'] if rows else ['        ;;']
    return lines


def text(tool, header, devices):
    cases = [line for command in tool.commands for line in case(command)]
    settings = [f"        {model} | {model}[:@]*) words_of='{' '.join(names)}' ;;"
                for model, names in tool.settings.items()]
    values = [f"        {model}/{name}) words_of='{' '.join(words)}' ;;"
              for model, names in tool.settings.items() for name, words in names.items() if words]
    return FRAME.format(header=header, devices=' '.join(devices), cases='\n'.join(cases),
                        commands=' '.join(command.name for command in tool.commands),
                        settings='\n'.join(settings), values='\n'.join(values))
