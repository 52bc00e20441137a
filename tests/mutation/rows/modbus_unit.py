# SPDX-License-Identifier: MIT
ROWS = (
    ('pace-from-submit', 'modbus_unit.h: the pace counts from the last request on the wire',
     'unit/test_modbus_unit',
     ('src/modbus_unit.c', 'advance',
      'unit->pause_us = unit->pace_us; } else if (unit->state != ASKED || unit->attempts != 0) {',
      '} else {')),
    ('half-an-address', 'modbus_unit.h: an outcome is for the question that it answers',
     'unit/test_modbus_unit',
     ('src/modbus_unit.c', 'fathom_modbus_unit_ask',
      'if (unit->state != IDLE && unit->asked == fathom_modbus_unit_name(question) && !is_anothers) {',
      'if (unit->state != IDLE && unit->asked >> 8 == fathom_modbus_unit_name(question) >> 8 && '
      '!is_anothers) {')),
    ('clock-wrap', 'modbus_unit.h: the pace holds across the wrap of the clock', 'unit/test_modbus_unit',
     ('src/modbus_unit.c', 'advance',
      'const uint32_t passed_us = fathom_elapsed_us(now, unit->polled_us);',
      'const uint32_t passed_us = now > unit->polled_us ? now - unit->polled_us : 0;')),
    ('warm-up-hides-all', 'modbus_unit.h: silent, not understood or refused',
     'unit/test_modbus_setting unit/test_hps167s_options',
     ('src/modbus_unit.c', 'outcome',
      '(status != FATHOM_ERR_NO_ANSWER && status != FATHOM_ERR_CHECKSUM && status != FATHOM_ERR_EXCEPTION))',
      'status >= 0)')),
)
