# SPDX-License-Identifier: MIT
ROWS = (
    ('select-too-short', 'a05_auto.h: low in the first second, FATHOM_A05_SELECT_US',
     'unit/test_a05_auto',
     ('src/sensor/a05_auto.c', 'fathom_a05_auto_select',
      'sensor->select_left_us = FATHOM_A05_SELECT_US;',
      'sensor->select_left_us = FATHOM_A05_SELECT_US / 2;')),
    ('implausible-probe-passes', 'a05_auto.h: where its place is not sure a frame with an odd probe is no frame',
     'unit/test_a05_auto',
     ('src/sensor/a05_auto.c', 'believed', '(odd == 0u) || (', 'true || (')),
    ('unsure-place-passes', 'a05_auto.h: the same, after a frame with an odd probe',
     'unit/test_a05_auto',
     ('src/sensor/a05_auto.c', 'believed', 'sensor->base.stream.sure && sensor->was_odd', 'sensor->was_odd')),
    ('newly-odd-passes', 'a05_auto.h: a frame in which a probe turns odd may be damaged',
     'unit/test_a05_auto',
     ('src/sensor/a05_auto.c', 'believed', 'sensor->base.stream.sure && sensor->was_odd', 'sensor->base.stream.sure')),
)
