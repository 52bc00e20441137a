# SPDX-License-Identifier: MIT
ROWS = (
    ('implausible-probe-passes', 'dyp_auto.h: a frame with a probe that cannot be is no frame',
     'unit/test_a05_auto',
     ('src/dyp_auto.c', 'all_plausible',
      '!fathom_dyp_plausible(&sensor->answer.window, *value)) return false; return true;',
      'fathom_dyp_plausible(&sensor->answer.window, *value)) return true; return false;')),
)
