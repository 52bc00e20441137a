# SPDX-License-Identifier: MIT
ROWS = (
    ('select-too-short', 'a05_auto.h: low in the first second, FATHOM_A05_SELECT_US',
     'unit/test_a05_auto',
     ('src/a05_auto.c', 'fathom_a05_auto_power_on',
      'sensor->select_left_us = FATHOM_A05_SELECT_US;',
      'sensor->select_left_us = FATHOM_A05_SELECT_US / 2;')),
)
