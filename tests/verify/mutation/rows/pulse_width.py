# SPDX-License-Identifier: MIT
ROWS = (
    ('other-speed-of-sound', 'pulse_width.h: us * 4 / 23, which is T / 57.5',
     'unit/test_pulse_width unit/test_a16_pwm',
     ('src/codec/pulse_width.c', 'fathom_pulse_width_mm',
      '((bounded_us(width_us) * 4u) + 11u) / 23u',
      '(bounded_us(width_us) * 174 + 500) / 1000')),
    ('cold-is-warm', 'pulse_width.h: 0.606 m/s more for each degree', 'unit/test_pulse_width',
     ('src/codec/pulse_width.c', 'fathom_pulse_width_mm_in_air',
      '(uint16_t)(air_dc - FATHOM_PULSE_WIDTH_MIN_AIR_DC)',
      '(uint16_t)(FATHOM_PULSE_WIDTH_MAX_AIR_DC - air_dc)')),
)
