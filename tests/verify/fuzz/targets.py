# SPDX-License-Identifier: MIT
"""The targets: what each is made of, and how often it is run."""
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
    # A second of a core does at least so many executions: a fifth of what it did when this was written, or less.
    least: int
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
    Target('modbus_rtu', (build.core,), 8000, 170, 300),
    Target('figures', (build.core,), 8000, 150, 64),
    Target('hps167s', (build.core,), 8000, 160, 64),
    Target('dyp', (build.core,), 5000, 105, 128),
    Target('line', (build.core,), 1500, 40, 96, more=('tests/verify/fuzz/wire.c',)),
    Target('drivers', (build.core,), 500, 20, 128, more=('tests/verify/fuzz/wire.c',)),
    Target('pins', (build.core,), 1500, 50, 96),
    Target('tcp', (build.core, build.libmodbus), 1000, 25, 160,
           link=(*wrap('recv', 'send', 'poll', 'shutdown', 'setsockopt'), *LIBMODBUS)),
    Target('libmodbus', (build.core,), 8000, 190, 280, link=LIBMODBUS),
    Target('decode', (build.core, build.tool), 500, 10, 300, TOOL, TOOL_SOURCES, True),
    Target('options', (build.core, build.tool), 1500, 36, 300, TOOL, TOOL_SOURCES, True),
    Target('files', (build.core, build.tool), 1500, 34, 1000, TOOL, TOOL_SOURCES, True),
    Target('site', (build.core, build.publish), 500, 10, 1000, (*TOOL, *PUBLISH), TOOL_SOURCES, True),
]
