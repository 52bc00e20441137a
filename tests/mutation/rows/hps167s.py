# SPDX-License-Identifier: MIT
ROWS = (
    ('over-range-is-target', 'hps167s.h: from 65530 it is over range: no target',
     'unit/test_hps167s unit/test_hps167s_decode',
     ('src/hps167s.c', 'fathom_hps167s_decode_within',
      'const bool is_over = raw >= limits->over_range_mm;',
      'const bool is_over = raw > limits->over_range_mm;'),
     ('src/hps167s.c', 'fathom_hps167s_decode_within',
      'if (raw > limits->max_mm && !is_over) return FATHOM_ERR_MALFORMED;',
      'if (raw > limits->max_mm && raw < limits->over_range_mm) return FATHOM_ERR_MALFORMED;')),
    ('sample-written-on-error', 'sensor.h: on an error the outputs are as they were',
     'unit/test_hps167s unit/test_hps167s_decode',
     ('src/hps167s.c', 'fathom_hps167s_decode_within',
      'if (!fathom_hps167s_is_abnormal(registers)) {',
      'sample->raw = raw; if (!fathom_hps167s_is_abnormal(registers)) {')),
)
