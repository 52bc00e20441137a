# SPDX-License-Identifier: MIT
"""Shells that complete command lines of `fathom`: each gives for every line the words that may stand in place of its
last one."""
import os
import pty
import re
import subprocess
import time

import e2e

COMPLETIONS = f'{e2e.ROOT}/examples/fathom/install/completions'
# The stubs run `fathom`.
ENVIRONMENT = {'PATH': f'{os.path.dirname(os.path.abspath(e2e.FATHOM))}:/usr/bin:/bin', 'LC_ALL': 'C.UTF-8', 'TERM': 'dumb', 'HOME': '/nonexistent'}

BASH = r'''
. /usr/share/bash-completion/bash_completion
. "$1"
COMP_LINE=$2 COMP_POINT=${#2} COMP_TYPE=9 COMP_KEY=9
shift 2
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
_fathom fathom "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}" 2>/dev/null
printf '%s\n' "${COMPREPLY[@]}"
'''
# What completion adds is written down, and then END.
ZSH = r'''
fpath=(%(folder)s $fpath)
autoload -Uz compinit && compinit -u -D
compadd() {
    if [[ ${@[1,(i)(-|--)]} == *-[OAD]\ * ]]; then
        builtin compadd "$@"
        return
    fi
    local -a hits
    builtin compadd -A hits "$@"
    (( $#hits )) && print -rl -- $hits >>%(taken)s
    builtin compadd "$@"
}
complete-and-tell() {
    zle complete-word
    print END >>%(taken)s
}
zle -N complete-and-tell
bindkey '^I' complete-and-tell
setopt no_beep no_auto_list
unset zle_bracketed_paste
print READY >>%(taken)s
'''


def run(*command, **options):
    return subprocess.run(command, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True,
                          check=True, timeout=e2e.PATIENCE, **options).stdout.split('\n')


def by_bash(lines, folder):
    """With the words as bash cuts them: what is in COMP_WORDBREAKS is a word of its own."""
    for line in lines:
        words = [part for word in line.split(' ') for part in (re.findall(r'[:=@]+|[^:=@]+', word) or [''])]
        if re.search('[:=@]$', line):
            words.append('')
        kept = re.search(r'[^ ]*[:=@]$|$', line[:len(line) - len(words[-1])])[0]  # what bash leaves as it is
        found = run('bash', '--norc', '-c', BASH, 'bash', f'{COMPLETIONS}/fathom', line, *words, cwd=folder)
        yield {kept + word for word in found if word}


def by_fish(lines, folder):
    for line in lines:
        script = f'source {COMPLETIONS}/fathom.fish; complete -C $argv[1]'
        found = run('fish', '--no-config', '-c', script, line, cwd=folder)
        yield {word.split('\t')[0] for word in found if word}


def by_zsh(lines, folder):
    """Typed into a shell at a terminal."""
    taken, script = os.path.join(folder, 'taken'), os.path.join(folder, 'script')
    with open(script, 'w', encoding='ascii') as file:
        file.write(ZSH % {'folder': COMPLETIONS, 'taken': taken})
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.execve('/usr/bin/zsh', ['zsh', '-f', '-i'], ENVIRONMENT)
    try:
        os.write(terminal, f' . {script}\n'.encode())
        wait_for('READY', taken, terminal)
        for line in lines:
            os.remove(taken)
            os.write(terminal, b'\x15' + line.encode() + b'\t')  # Ctrl-U takes away the line before
            kept = re.search(r'[^ ]*=|$', line[line.rfind(' ') + 1:])[0]
            yield {kept + word.strip() for word in wait_for('END', taken, terminal)[:-1]}
    finally:
        os.close(terminal)  # which hangs it up
        os.waitpid(pid, 0)


def wait_for(word, path, terminal):
    """The lines of the file, of which the last one is the word. What the terminal shows is thrown away."""
    deadline = time.monotonic() + e2e.PATIENCE
    shown = b''
    while time.monotonic() < deadline:
        if e2e.is_ready(terminal, 0.05):
            shown += os.read(terminal, 4096)
        if os.path.exists(path):
            with open(path, encoding='utf-8') as file:
                lines = file.read().split('\n')
            if lines[-2:] == [word, '']:
                return lines[:-1]
    raise AssertionError(f'{word} did not come: {shown.decode(errors="replace")}')


SHELLS = {'bash': by_bash, 'zsh': by_zsh, 'fish': by_fish}
