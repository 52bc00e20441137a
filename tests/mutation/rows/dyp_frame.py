# SPDX-License-Identifier: MIT
ROWS = (
    ('sum-without-last-value', 'dyp_frame.h: the sum of all bytes before it',
     'unit/test_dyp_frame golden/test_frames',
     ('src/dyp_frame.c', 'fathom_dyp_frame_valid',
      'sum == *frame',
      '(uint8_t)(sum - frame[-1]) == *frame')),
)
