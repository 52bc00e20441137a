# SPDX-License-Identifier: MIT
ROWS = (
    ('crc-not-checked', 'modbus_client.h: a response with a wrong CRC is never a result',
     'unit/test_line_hostile unit/test_corruption',
     ('src/engine/modbus_client.c', '',
      'static const fathom_protocol_t protocol = {fathom_modbus_client_encode, length, fathom_crc16,',
      'static uint16_t unchecked(const uint8_t *frame, uint8_t count) { return frame != NULL ? 0 : count; } '
      'static const fathom_protocol_t protocol = {fathom_modbus_client_encode, length, unchecked,')),
    ('half-a-crc', 'modbus_client.h: a response with a wrong CRC is never a result',
     'unit/test_line_random',
     ('src/engine/modbus_client.c', '',
      'static const fathom_protocol_t protocol = {fathom_modbus_client_encode, length, fathom_crc16,',
      'static uint16_t half(const uint8_t *frame, uint8_t count) { return (uint8_t)fathom_crc16(frame, count); } '
      'static const fathom_protocol_t protocol = {fathom_modbus_client_encode, length, half,')),
    ('reads-unit-0', 'modbus_client.h: the client without unit 0 does not read it', 'unit/test_line_listening',
     ('src/engine/modbus_client.c', 'fathom_modbus_client_submit',
      'if (fathom_modbus_client_reads_0(request)) return FATHOM_ERR_UNSUPPORTED;', '')),
    ('zeros-are-frames', 'modbus_client.h: no frame of unit 0 is looked for where it has not been asked',
     'unit/test_address_zero',
     ('src/engine/modbus_client_zero.c', 'fathom_modbus_client_submit_with_zero',
      'if (fathom_modbus_client_reads_0(request) || (request->message.head[0] == FATHOM_MODBUS_ANY_UNIT)) return'
      ' fathom_modbus_client_start(line, request, &protocol); return fathom_modbus_client_submit(line, request);',
      'return fathom_modbus_client_start(line, request, &protocol);')),
)
