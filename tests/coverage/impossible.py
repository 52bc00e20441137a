# SPDX-License-Identifier: MIT
"""What no test on a host can execute, each with its reason: (file, what, source text): why. An entry that a test executes,
or that is gone, fails; so the list may only become shorter."""
IMPOSSIBLE = {
}
