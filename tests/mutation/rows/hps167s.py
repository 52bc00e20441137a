# SPDX-License-Identifier: MIT
ROWS = (
    ('over-range-is-target', 'hps167s.h: from 65530 it is over range: no target',
     'unit/test_hps167s unit/test_hps167s_decode',
     ('src/hps167s.c', 'fathom_hps167s_decode_within',
      'const bool is_target = raw >= MIN_MM && raw <= limits->max_mm;',
      'const bool is_target = (raw >= MIN_MM && raw <= limits->max_mm) || raw == limits->over_range_mm;')),
    ('sample-written-on-error', 'sensor.h: on an error the outputs are as they were',
     'unit/test_hps167s unit/test_hps167s_decode',
     ('src/hps167s.c', 'fathom_hps167s_decode_within',
      'if (raw != FAILURE) {',
      'sample->raw = raw; if (raw != FAILURE) {')),
)
