# SPDX-License-Identifier: MIT
ROWS = (
    ('fault-is-far', 'debounce.h: a fault holds the level', 'unit/test_debounce',
     ('src/engine/debounce.c', 'fathom_debounce_sample',
      'case FATHOM_NO_TARGET:',
      'case FATHOM_NO_TARGET: case FATHOM_FAULT:')),
    ('unknown-is-far', 'debounce.h: an unknown value neither changes the level nor holds it for ever',
     'unit/test_debounce',
     ('src/engine/debounce.c', 'fathom_debounce_sample',
      'case FATHOM_NO_TARGET:',
      'case FATHOM_NO_TARGET: case FATHOM_UNKNOWN:')),
)
