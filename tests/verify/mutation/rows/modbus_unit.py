# SPDX-License-Identifier: MIT
ROWS = (
    ('pace-from-submit', 'modbus_unit.h: the pace counts from the last request on the wire',
     'unit/test_modbus_unit',
     ('src/engine/modbus_unit.c', 'fathom_modbus_unit_poll',
      'if ((transaction->attempts == 0u) || (transaction->attempts != unit->attempts)) unit->pause_us ='
      ' unit->pace_us;',
      '')),
    ('half-an-id', 'modbus_unit.h: an outcome is for the request that it answers',
     'unit/test_modbus_unit_turns',
     ('src/engine/modbus_unit.c', 'fathom_modbus_unit_ask',
      'if ((unit->state != IDLE) && (unit->current == id) && !is_anothers) {',
      'if (unit->state != IDLE && unit->current >> 4 == id >> 4 && !is_anothers) {')),
    ('clock-wrap', 'modbus_unit.h: the pace holds across the wrap of the clock', 'unit/test_modbus_unit',
     ('src/engine/modbus_unit.c', 'fathom_modbus_unit_poll',
      'const uint32_t passed_us = fathom_elapsed_us(now_us, unit->polled_us);',
      'const uint32_t passed_us = now_us > unit->polled_us ? now_us - unit->polled_us : 0;')),
    ('warm-up-hides-all', 'modbus_unit.h: silent, not understood or refused',
     'unit/test_modbus_setting unit/test_hps167s_options',
     ('src/engine/modbus_unit.c', 'outcome',
      'if ((unit->warm_us == 0u) || ((status != FATHOM_ERR_NO_RESPONSE) && (status != FATHOM_ERR_CHECKSUM) &&'
      ' (status != FATHOM_ERR_EXCEPTION)))',
      'if (unit->warm_us == 0 || status >= 0)')),
)
