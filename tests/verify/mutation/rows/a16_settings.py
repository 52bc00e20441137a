# SPDX-License-Identifier: MIT
ROWS = (
    ('polarity-inverted', 'a16_settings.h: 0 is negative, 1 positive', 'unit/test_a16_settings',
     ('src/sensor/a16_settings.c', 'fathom_a16_modbus_switch_polarity',
      'if (status == FATHOM_READY) *polarity = (fathom_a16_polarity_t)value;',
      'if (status == FATHOM_READY) *polarity = (fathom_a16_polarity_t)(1 - value);')),
    ('polarity-set-in-data-type', 'A16 6: 0x0205 is the polarity', 'unit/test_a16_settings',
     ('src/sensor/a16_settings.c', 'fathom_a16_modbus_set_switch_polarity',
      'return set_choice(sensor, FATHOM_A16_REGISTER_SWITCH_POLARITY, (unsigned)polarity);',
      'return set_choice(sensor, FATHOM_A16_REGISTER_AUTOMATIC_VALUE, (unsigned)polarity);')),
    ('mode-read-back', 'a16_settings.h: the operating mode is write-only', 'unit/test_a16_settings',
     ('src/sensor/a16_settings.c', 'fathom_a16_modbus_set_operating_mode',
      'return fathom_dyp_modbus_write(&sensor->base, FATHOM_A16_REGISTER_OPERATING_MODE, (uint16_t)mode);',
      'return fathom_dyp_modbus_set(&sensor->base, FATHOM_A16_REGISTER_OPERATING_MODE, (uint16_t)mode);')),
)
