# SPDX-License-Identifier: MIT
"""The targets: their sources, how often each runs, and what a run must reach at least."""
import dataclasses
import os

import build

LIBMODBUS = ('-lmodbus',)


def wrap(*names):
    return [f'-Wl,--wrap={name}' for name in names]


@dataclasses.dataclass
class Target:
    name: str
    sources: tuple  # functions of build.py
    least: int  # executions in a second of a core: a fifth of today's, or less
    edges: int  # the least number that a run of some seconds reaches: four fifths of today's
    share: int  # of a thousand executions of the full form: by their speed
    longest: int = 256  # bytes of an input
    link: tuple = ()
    more: tuple = ()  # sources beside fuzz_NAME.c
    is_weighted: bool = False  # inputs that reach what few others do are changed more often

    def all_sources(self):
        found = [f'tests/verify/fuzz/fuzz_{self.name}.c', 'tests/verify/fuzz/fuzz.c', *self.more]
        for group in self.sources:
            found += group()
        return found

    def program(self):
        return os.path.join(build.FOLDER, 'fuzz_' + self.name)


# What would reach the system: tool.c has all of it.
TOOL = (*wrap('fopen', 'open', 'stat', 'lstat', 'fsync', 'rename', 'remove', 'unlink', 'realpath', 'opendir',
              'getaddrinfo', 'fathom_sim_pty_open'), *LIBMODBUS, '-lm')
PUBLISH = ('-lmosquitto', '-lyaml', '-lssl', '-lcrypto')
TOOL_SOURCES = ('tests/verify/fuzz/tool.c',)

TARGETS = [
    Target('dyp', (build.core,), 5000, 136, 105, 128),
    Target('line', (build.core,), 1500, 620, 40, 96, more=('tests/verify/fuzz/wire.c',)),
    Target('drivers', (build.core,), 500, 1270, 20, 128, more=('tests/verify/fuzz/wire.c',)),
    Target('tcp', (build.core, build.libmodbus), 1000, 500, 25, 160,
           link=(*wrap('recv', 'send', 'poll', 'shutdown', 'setsockopt'), *LIBMODBUS)),
    Target('libmodbus', (build.core,), 8000, 145, 190, 280, link=LIBMODBUS),
    Target('decode', (build.core, build.tool), 1000, 700, 36, 300, TOOL, TOOL_SOURCES, True),
    Target('options', (build.core, build.tool), 1500, 1200, 36, 300, TOOL, TOOL_SOURCES, True),
    Target('files', (build.core, build.tool), 1500, 200, 34, 1000, TOOL, TOOL_SOURCES, True),
    Target('site', (build.core, build.publish), 500, 130, 10, 1000, (*TOOL, *PUBLISH), TOOL_SOURCES, True),
]
