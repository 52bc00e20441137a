# SPDX-License-Identifier: MIT
ROWS = (
    ('low-byte-first', 'dyp_55aa.h: H before L', 'unit/test_dyp_55aa',
     ('src/codec/dyp_55aa.c', 'fathom_dyp_55aa_encode_response',
      'at[0] = (uint8_t)(*values >> 8); at[1] = (uint8_t)*values;',
      'at[0] = (uint8_t)*values; at[1] = (uint8_t)(*values >> 8);')),
    ('one-value-too-many', 'dyp_55aa.h: decode copies 4, 1 or none', 'unit/test_dyp_55aa',
     ('src/codec/dyp_55aa.c', 'fathom_dyp_55aa_decode',
      'fathom_dyp_55aa_values(frame[COMMAND])',
      '(uint8_t)(fathom_dyp_55aa_values(frame[COMMAND]) + 1)')),
)
