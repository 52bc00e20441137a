# SPDX-License-Identifier: MIT
"""What no test on a host can execute, each with its reason: (file, what, source text): why. An entry that a test executes,
or that is gone, fails; so the list may only become shorter."""
OTHER_GLIBC = 'a constant: true from glibc 2.42 on, false before'

IMPOSSIBLE = {
    ('port/posix/settings.c', 'branch true', 'B9600 == 9600'): OTHER_GLIBC,
    ('port/posix/settings.c', 'branch false', 'B9600 == 9600'): OTHER_GLIBC,
}
