# SPDX-License-Identifier: MIT
"""The mutants that mean the same as the code without them, so that no test can see them. A row: why it means the same,
and the identities of those of which this is true, as run.py prints them; space does not count."""
COUNT = 0  # of the identities; whoever adds one says so here

ROWS = [
]

assert sum(len(row) - 1 for row in ROWS) == COUNT
