# SPDX-License-Identifier: MIT
ROWS = (
    ('alias-ignored', 'a05_modbus.h: the block of registers that the config names', 'unit/test_a05_modbus',
     ('src/sensor/a05_modbus.c', 'fathom_a05_modbus_init',
      'base->request.first = (uint16_t)(registers + first);',
      'base->request.first = (uint16_t)(FATHOM_A05_REGISTERS + first);')),
)
