# SPDX-License-Identifier: MIT
ROWS = (
    ('pace-of-one-probe', 'a05_dyp.h: 250 ms from one command to the next', 'unit/test_a05_dyp',
     ('src/sensor/a05_dyp.c', 'fathom_a05_dyp_init',
      'is_single ? FATHOM_A05_DYP_ONE_PROBE_US : FATHOM_A05_DYP_ALL_PROBES_US',
      'FATHOM_A05_DYP_ONE_PROBE_US')),
)
