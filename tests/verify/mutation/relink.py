# SPDX-License-Identifier: MIT
"""Programs of a build that is there, linked anew with single sources changed. The build is left as it is."""
import os
import re
import shlex
import subprocess
import sys

from planted import Bad

FOLDERS = ('examples', 'include', 'port', 'src', 'tests')


def command(words, cwd, what):
    done = subprocess.run(words, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        errors = [line for line in done.stdout.splitlines() if re.search('error|FAILED|undefined', line, re.I)]
        raise Bad('\n    '.join([what, *errors[:5]]))
    return done.stdout


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


class Build:
    """What Unix Makefiles of CMake have made in a folder."""

    def __init__(self, folder):
        self.folder = folder
        self.objects = {}  # object file: (folder and command that made it, without -o, and the files that it needs)
        self.links = {}  # program or archive: the same
        for where, folders, names in os.walk(folder):
            if where == folder and 'firmware' in folders:
                folders.remove('firmware')  # made by other compilers
            if 'build.make' in names:
                self.add_objects(where)
            if 'link.txt' in names:
                cwd = os.path.dirname(os.path.dirname(where))
                words = shlex.split(read(where, 'link.txt').splitlines()[0])  # of an archive: without ranlib
                self.links[os.path.normpath(os.path.join(cwd, words[output(words)]))] = (cwd, words)
        if not self.links:
            raise Bad(f'{folder}: no program has been made there by Unix Makefiles')

    def add_objects(self, where):
        flags = dict(re.findall(r'^(C_\w+) = (.*)$', read(where, 'flags.make'), re.M)) \
            if os.path.exists(os.path.join(where, 'flags.make')) else {}
        for cwd, line, name in re.findall(r'^\t(?:cd (\S+) && )?(.+) -o (\S+\.(?:o|obj)) -c \S+$',
                                          read(where, 'build.make'), re.M):
            cwd = cwd or self.folder
            path = os.path.normpath(os.path.join(cwd, name))
            if not os.path.exists(path + '.d'):
                continue
            line = re.sub(r'\$\((\w+)\)', lambda found: flags.get(found[1], ''), line)
            words = shlex.split(re.sub(r' -M\w( -M\w \S+)*', '', line))
            needs = [os.path.normpath(os.path.join(cwd, need))
                     for need in read(path + '.d').replace('\\\n', ' ').split()[1:]]
            self.objects[path] = (cwd, [*words[words[0].endswith('ccache'):], '-c', needs[0]], set(needs))


def output(words):
    """Where a command that links has what it makes."""
    return words.index('-o') + 1 if '-o' in words else 2  # of ar


class Overlay:
    """The sources as links, some of which are files for a while, and a folder for what comes of them."""

    def __init__(self, root, folder):
        self.root, self.folder, self.out = root, folder, os.path.join(folder, 'out')
        os.makedirs(self.out)
        os.symlink(os.path.join(root, 'LICENSE'), os.path.join(folder, 'LICENSE'))  # which the Arduino library has
        for top in FOLDERS:
            for where, _, names in os.walk(os.path.join(root, top)):
                into = os.path.join(folder, os.path.relpath(where, root))
                os.makedirs(into)
                for name in names:
                    os.symlink(os.path.join(where, name), os.path.join(into, name))
        self.there = re.compile(re.escape(root) + rf'/({"|".join(FOLDERS)})(?![\w-])')
        self.texts, self.made = {}, {}

    def change(self, texts):
        """Puts {path: text} in place of the sources, until restore."""
        self.texts, self.made = texts, {}
        for name, text in texts.items():
            path = os.path.join(self.folder, name)
            os.remove(path)
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)

    def restore(self):
        for name in self.texts:
            path = os.path.join(self.folder, name)
            os.remove(path)
            os.symlink(os.path.join(self.root, name), path)
        self.texts = {}

    def compile(self, build, path):
        """An object anew; None when nothing that it needs has changed."""
        cwd, words, needs = build.objects[path]
        if not any(os.path.join(self.root, name) in needs for name in self.texts):
            return None
        made = os.path.join(self.out, f'{len(self.made)}.o')
        moved = [self.there.sub(rf'{self.folder}/\1', word) for word in words]
        command([*moved, '-w', '-Wno-error', '-o', made], cwd, 'it does not compile')
        return made

    def link(self, build, path):
        """A program or an archive anew, in a folder for it; None when nothing in it has changed."""
        cwd, words = build.links[path]
        words, is_changed = list(words), False
        for i, word in enumerate(words):
            part = os.path.normpath(os.path.join(cwd, word))
            if part == path or part not in build.objects and part not in build.links:
                continue
            if part not in self.made:
                self.made[part] = (self.compile if part in build.objects else self.link)(build, part)
            if self.made[part]:
                words[i], is_changed = self.made[part], True
        if not is_changed:
            return None
        made = words[output(words)] = os.path.join(self.out, os.path.basename(path))
        if os.path.exists(made):
            os.remove(made)
        if path.endswith('.a'):
            words[1] = 'qcs'
        command(words, cwd, 'it does not link')
        return made

    def images(self, build, into):
        """All images of a machine in the folder `into`: links to those in which nothing has changed."""
        os.makedirs(into, exist_ok=True)
        made = {path: self.link(build, path) for path in build.links if path.endswith('.elf')}
        for path, new in made.items():
            link = os.path.join(into, os.path.basename(path))
            if os.path.lexists(link):
                os.remove(link)
            os.symlink(new or path, link)
        if not any(made.values()):
            raise Bad('no image is made of what it changes')

    def sketches(self, into):
        """The same for Arduino, by its own builder. Returns where the images are."""
        command([sys.executable, os.path.join(self.folder, 'tests/firmware/arduino/build.py'), into], self.folder,
                'it does not compile')
        return os.path.join(into, 'images')
