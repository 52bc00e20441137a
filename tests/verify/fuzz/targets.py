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
    runs: int  # executions of the quick form: about 8 s of a core
    edges: int  # the least number that so many executions reach: four fifths of today's
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
    Target('dyp', (build.core,), 320000, 136, 128),
    Target('line', (build.core,), 70000, 860, 96, more=('tests/verify/fuzz/wire.c',)),
    Target('drivers', (build.core,), 32000, 1600, 128, more=('tests/verify/fuzz/wire.c',)),
    Target('tcp', (build.core, build.libmodbus), 40000, 650, 160,
           link=(*wrap('recv', 'send', 'poll', 'shutdown', 'setsockopt'), *LIBMODBUS)),
    Target('libmodbus', (build.core,), 800000, 145, 280, link=LIBMODBUS),
    Target('decode', (build.core, build.tool), 24000, 700, 300, TOOL, TOOL_SOURCES, True),
    Target('options', (build.core, build.tool), 16000, 1800, 300, TOOL, TOOL_SOURCES, True),
    Target('files', (build.core, build.tool), 160000, 290, 1000, TOOL, TOOL_SOURCES, True),
    Target('site', (build.core, build.publish), 44000, 160, 1000, (*TOOL, *PUBLISH), TOOL_SOURCES, True),
]
