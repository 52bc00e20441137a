# SPDX-License-Identifier: MIT
"""What the tool says of itself: its help, cut into parts, and what its options take, by asking it with a value that is
none. The pages of man and the completions are made of this alone, so a new command or option is in all of them."""
import os
import re
import subprocess

TEXT = 20  # the column where a row's text begins, counted from 0; what is longer before it has two blanks behind it
OPTION = re.compile(r'(--[\w-]+)(\[=([^\]]+)\]| (\S.*?))?(?:, (-\w))?$')
# A value like these is a path, which a shell completes.
PATHS = {'FILE', 'PATH'}
# A value like these is one of a few words, which the tool names when it is given another one.
WORDS = {'FORMAT', 'P', 'ECHO', 'MODE', 'VALUE', 'MODEL', 'NAME', 'RATE', 'R'}
WORDS_OF = {'--baud', '--parity'}
WORD = re.compile(r'[\w.-]+')


class Item:
    """A row: what stands before its text, its text, and the rows below it."""

    def __init__(self, tag, text):
        self.tag, self.text, self.below = tag, text, []


class Option(Item):
    """long, short (or None), value (as the help names it, or None), is_optional: only as --long=VALUE."""

    def __init__(self, item, match):
        super().__init__(item.tag, item.text)
        self.long = match[1]
        self.value, self.is_optional = match[3] or match[4], match[3] is not None
        self.choices = []  # words that it takes, if those are few
        self._short = match[5]

    @property
    def short(self):
        also = re.search(r'\bAlso (-\w) ', self.text)
        return also[1] if also else self._short

    @property
    def is_path(self):
        return self.value in PATHS

    @property
    def names(self):
        return [self.long, self.short] if self.short else [self.long]


class Help:
    """`fathom COMMAND --help`: before (paragraphs and rows above the options), options (rows, and paragraphs between
    them), after; usage and examples (rows); status (text)."""

    def __init__(self, text):
        self.usage, self.examples, self.status, self.blocks = [], [], '', []
        self.examples_title = ''
        part, item = None, None
        for line in text.splitlines():
            if line.startswith(('usage:', 'examples')) or (line.endswith('terminals:') and not line.startswith(' ')):
                part = self.usage if line.startswith('usage:') else self.examples
                self.examples_title = line if part is self.examples else ''
                line = '  ' + line[len('usage:'):].strip() if line.startswith('usage:') else ''
            elif line.startswith('Exit status: '):
                part, self.status, line = 'status', line[len('Exit status: '):], ''
                continue
            if not line:
                if part is not self.examples or self.examples:
                    part = None if part is not self.blocks else part
                item = None
            elif part == 'status':
                self.status += ' ' + line.strip()
            elif not line.startswith(' '):
                part = self.blocks
                if item is None or not isinstance(item, str):
                    self.blocks.append('')
                self.blocks[-1] = item = ' '.join(filter(None, (self.blocks[-1], line)))
                self.plain_rows()
                item = self.blocks[-1] if isinstance(self.blocks[-1], str) else None
            else:
                part = self.blocks if part is None else part
                item = self.row(part, item, line)
        places = [at for at, block in enumerate(self.blocks) if isinstance(block, Option)]
        first, last = (places[0], places[-1] + 1) if places else (len(self.blocks), len(self.blocks))
        self.before, self.options, self.after = self.blocks[:first], self.blocks[first:last], self.blocks[last:]

    def plain_rows(self):
        """`fathom --version   prints the version`, at the begin of a line, is a row too."""
        cells = re.split(r' {3,}', self.blocks[-1])
        if len(cells) == 2:
            self.blocks[-1] = Item(*cells)

    @staticmethod
    def row(part, item, line):
        depth = len(line) - len(line.lstrip())
        usage = re.match(r' {7}(fathom .*)', line)
        if usage:
            line, depth = '  ' + usage[1], 2
        cells = re.split(r' {3,}' if line.startswith('  fathom ') else r' {2,}', line.strip())
        if depth == 4 and isinstance(item, Item):
            if len(cells) == 3:
                cells = [cells[0], f'{cells[1]} {cells[2]}']
            item.below += [Item(*pair) for pair in zip(cells[::2], cells[1::2])]
            return item
        if depth > 2 and isinstance(item, Item):
            item.text = ' '.join(filter(None, (item.text, '; '.join(cells))))
            return item
        if len(cells) == 1 and len(line) > TEXT and line[TEXT - 1] == ' ' and not line.startswith('  fathom '):
            cells = [line[:TEXT].strip(), line[TEXT:].strip()]
        item = Item(cells[0], '; '.join(cells[1:]))
        match = OPTION.match(item.tag)
        if match:
            item = Option(item, match)
        part.append(item)
        return item


class Command:
    """name, summary, help, options (without what stands between them)."""

    def __init__(self, tool, name, summary):
        self.name, self.summary = name, summary
        self.help = Help(tool.says(name, '--help'))
        self.options = [row for row in self.help.options if isinstance(row, Option)]
        self.options.append(Option(Item('--help', 'explains it, with examples'), OPTION.match('--help')))
        usage = re.sub(r'--[\w-]+ [A-Z]+', '', ' '.join(row.tag for row in self.help.usage))
        named_models = [model for model in tool.models if re.search(rf'\b{model}\b', usage)]
        operands = set(re.findall(r'[A-Z]{3,}', usage))
        self.takes_files = 'FILE' in operands
        self.takes_settings = 'SETTING' in operands
        self.takes_values = self.takes_settings and 'VALUE' in re.sub(r'\[.*?\]', '', usage)
        self.takes_several = bool(re.search(r'SENSOR\S*\.\.\.', usage))
        self.models = named_models or (list(tool.models) if 'SENSOR' in operands else [])
        for option in self.options:
            option.choices = tool.choices(self, option)
        # The words that may stand for a sensor.
        modes = {mode for option in self.options if option.long == '--mode' for mode in option.choices}
        self.sensors = list(self.models)
        if ':MODE' in usage:
            self.sensors += [f'{model}:{mode}' for model in self.models for mode in tool.models[model]
                             if not modes or mode in modes]


class Tool:
    def __init__(self, path):
        self.path = os.path.abspath(path)
        overview = self.says('--help')
        self.help = Help(overview)
        self.models = {}  # the modes of each
        for row in Help(self.says('read', '--help')).before:
            if isinstance(row, Item) and 'modes: ' in row.text:
                self.models[row.tag] = row.text.split('modes: ')[1].split(', ')
        self.settings = {model: self.settings_of(model) for model in self.models}
        rows = re.findall(r'^  (\w+) +(\S.*)$', overview.split('\n\n')[2], re.M)
        self.commands = [Command(self, *row) for row in rows]

    def run(self, *words):
        environment = {name: value for name, value in os.environ.items() if name != 'FATHOM_PORT'}
        return subprocess.run([self.path, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, check=False, timeout=20, env=environment)

    def says(self, *words):
        done = self.run(*words)
        if done.returncode != 0:
            raise SystemExit(f'fathom {" ".join(words)}: exit status {done.returncode}\n{done.stderr}')
        return done.stdout

    def settings_of(self, model):
        """{name: the words that it takes, if those are few}"""
        settings = {}
        for block in re.findall(r'^  (\S+)(?: \(\S+\))?\n      (.*)', self.says('get', model), re.M):
            values = block[1].rsplit(': ', 1)[-1].split(', ')
            settings[block[0]] = values if all(WORD.fullmatch(value) for value in values) else []
        return settings

    def choices(self, command, option):
        if option.below:
            return [row.tag.split('=')[0] + ('=' if '=' in row.tag else '') for row in option.below]
        if option.value is None:
            return []
        if option.value.islower():
            return [option.value]
        if option.value not in WORDS and option.long not in WORDS_OF:
            return []
        found = []
        port = ['--port', '/nowhere'] if any(other.long == '--port' for other in command.options) else []
        sensors = [[model] for model in command.models] + [['a05::modbus']]
        for words in sensors if command.models else [['1', '3', '0'], []]:
            said = self.run(command.name, *words, *port, option.long, '').stderr
            found += [word for word in named(said, option.long) if word not in found]
            if found and option.long != '--mode':
                break  # only the modes differ from model to model
        # What asks has fewer modes than what listens, and its help names them.
        told = [word for word in found if re.search(rf'\b{re.escape(word)}\b', option.text)]
        return told if option.long == '--mode' and told else found


def named(said, option):
    """The words of `--parity takes none, even or odd, not ''` and `there is no mode '' for a16, only auto, modbus`."""
    match = (re.search(rf"{option} (?:of \w+ )?takes (?:all, or some of )?([^;]*?)(?: with commas.*)?, not ''", said) or
             re.search(rf"there is no {option[2:]} ''[^;]*?, only ([^;]*)", said))
    words = re.split(r', | or | and ', match[1]) if match else []
    extra = ['all'] if match and 'takes all' in said else []
    return words + extra if all(WORD.fullmatch(word) for word in words) else []


def short(text):
    """Its first words, for a list of completions."""
    text = re.split(r'[.;:?](?: |$)', re.sub(r'[`"\[\]]| ?\([^)]*\)', '', text))[0]
    return text if len(text) <= 60 else re.sub(r'\s\S*$', '', text[:60])
