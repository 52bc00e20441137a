# SPDX-License-Identifier: MIT
ROWS = (
    ('probe-shifted', 'dyp.h: values begin with the first probe that was read', 'unit/test_dyp',
     ('src/dyp.c', 'fathom_dyp_next',
      'const uint16_t value = answer->values[probe - answer->first];',
      'const uint16_t value = answer->values[probe - 1];')),
)
