# SPDX-License-Identifier: MIT
ROWS = (
    ('clock-wrap', 'a16_rs232.h: a frame after the command confirms, across the wrap of the clock too',
     'unit/test_a16_rs232_limits',
     ('src/sensor/a16_rs232.c', 'is_since',
      'return fathom_elapsed_us(time_us, rs232->since_us) <= (UINT32_MAX / 2u);',
      'return time_us >= rs232->since_us;')),
)
