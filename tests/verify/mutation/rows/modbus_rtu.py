# SPDX-License-Identifier: MIT
ROWS = (
    ('unit-not-compared', 'modbus_rtu.h: PENDING for a frame of another unit', 'unit/test_modbus_rtu',
     ('src/codec/modbus_rtu.c', 'fathom_modbus_rtu_parse_response',
      'if ((frame[UNIT] != head[UNIT]) && (head[UNIT] != FATHOM_MODBUS_ANY_UNIT)) return FATHOM_PENDING;', '')),
    ('crc-bytes-swapped', 'Modbus over serial line V1.02, 2.5.1.2: low byte first',
     'unit/test_frames unit/test_modbus_rtu',
     ('src/codec/modbus_rtu.c', 'seal',
      'frame[length] = (uint8_t)crc; frame[length + 1u] = (uint8_t)(crc >> 8);',
      'frame[length] = (uint8_t)(crc >> 8); frame[length + 1u] = (uint8_t)crc;')),
)
