# SPDX-License-Identifier: MIT
ROWS = (
    ('clock-wrap', 'a16_controlled.h: it holds across the wrap of the clock', 'unit/test_a16_controlled',
     ('src/sensor/a16_controlled.c', 'is_in_time',
      'return sensor->waiting && (fathom_elapsed_us(time_us, sensor->edge_us) >= sensor->earliest_us) &&',
      'return sensor->waiting && time_us >= sensor->edge_us + sensor->earliest_us &&')),
)
