# SPDX-License-Identifier: MIT
ROWS = (
    ('unit-not-compared', "line.h: another unit's late response serves no retry", 'unit/test_dyp_client',
     ('src/engine/line_request.c', 'fathom_line_deliver',
      '(x->attempts == 0u) || !is_of(x, address) ||',
      'x->attempts == 0 ||')),
    ('echo-is-a-response', 'dyp_client.h: the echo of a read of all probes, with a response behind it, is none',
     'unit/test_line_echo_more',
     ('src/engine/dyp_client.c', 'check',
      'fathom_dyp_55aa_valid(frame, NEXT)', 'frame[NEXT] != frame[0]')),
)
