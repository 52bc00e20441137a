# SPDX-License-Identifier: MIT
ROWS = (
    ('probe-shifted', 'dyp.h: values begin with the first probe that was read', 'unit/test_dyp',
     ('src/sensor/dyp.c', 'fathom_dyp_measurement_next',
      'const uint16_t value = response->values[probe - response->first];',
      'const uint16_t value = response->values[probe - 1];')),
)
