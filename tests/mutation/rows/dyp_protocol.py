# SPDX-License-Identifier: MIT
ROWS = (
    ('low-byte-first', 'dyp_protocol.h: H before L', 'unit/test_dyp_protocol',
     ('src/dyp_protocol.c', 'fathom_dyp_protocol_encode_answer',
      '*at++ = (uint8_t)(*values >> 8); *at++ = (uint8_t)*values;',
      '*at++ = (uint8_t)*values; *at++ = (uint8_t)(*values >> 8);')),
    ('one-value-too-many', 'dyp_protocol.h: decode copies 4, 1 or none', 'unit/test_dyp_protocol',
     ('src/dyp_protocol.c', 'fathom_dyp_protocol_decode',
      'fathom_dyp_protocol_values(frame[COMMAND])',
      '(uint8_t)(fathom_dyp_protocol_values(frame[COMMAND]) + 1)')),
)
