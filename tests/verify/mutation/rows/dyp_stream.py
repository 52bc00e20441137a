# SPDX-License-Identifier: MIT
ROWS = (
    ('sum-without-last-value', 'dyp_stream.h: the sum of all bytes before it',
     'unit/test_dyp_stream unit/test_frames',
     ('src/codec/dyp_stream.c', 'fathom_dyp_stream_valid',
      'sum == *frame',
      '(uint8_t)(sum - frame[-1]) == *frame')),
)
