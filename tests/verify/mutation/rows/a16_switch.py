# SPDX-License-Identifier: MIT
ROWS = (
    ('polarity-on-error', 'a16_switch.h: only what was confirmed changes the meaning',
     'sim/test_switch_drivers',
     ('src/sensor/a16_switch.c', 'fathom_a16_switch_set_polarity',
      'if (status == FATHOM_READY) fathom_a16_switch_polarity_is(sensor, polarity);',
      'if (status != FATHOM_PENDING) fathom_a16_switch_polarity_is(sensor, polarity);')),
)
