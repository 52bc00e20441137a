# SPDX-License-Identifier: MIT
ROWS = (
    ('crc-not-checked', 'modbus_client.h: an answer with a wrong CRC is never a result',
     'unit/test_line_hostile golden/test_corruption',
     ('src/modbus_client.c', 'judge',
      'if (length != 0 && length <= have && fathom_crc16(bytes, length) == 0) {',
      'if (length != 0 && length <= have) {')),
    ('half-a-crc', 'modbus_client.h: an answer with a wrong CRC is never a result',
     'property/test_line_random',
     ('src/modbus_client.c', 'judge',
      'if (length != 0 && length <= have && fathom_crc16(bytes, length) == 0) {',
      'if (length != 0 && length <= have && (uint8_t)fathom_crc16(bytes, length) == 0) {')),
)
