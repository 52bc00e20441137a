# SPDX-License-Identifier: MIT
ROWS = (
    ('sum-without-last-value', 'dyp_frame.h: the sum of all bytes before it',
     'unit/test_dyp_frame golden/test_frames',
     ('src/dyp_frame.c', 'fathom_dyp_frame_valid',
      'fathom_dyp_sum(frame, last) == frame[last]',
      'fathom_dyp_sum(frame, (uint8_t)(last - 1)) == (uint8_t)(frame[last] - frame[last - 1] * (last > 3))')),
)
