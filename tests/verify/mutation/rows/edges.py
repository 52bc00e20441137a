# SPDX-License-Identifier: MIT
ROWS = (
    ('doubled-rise-begins-anew', 'edges.h: a rise seen twice is one, and the first counts', 'unit/test_edges',
     ('src/engine/edges.c', 'rise',
      'if (edges->high == 0u) {',
      'if ((edges->high == 0u) || edges->timed) {')),
    ('clock-wrap', 'edges.h: times may wrap', 'unit/test_edges',
     ('src/engine/edges.c', 'fall',
      'edges->pulses[at].width_us = fathom_elapsed_us(time_us, edges->rise_us);',
      'edges->pulses[at].width_us = time_us > edges->rise_us ? time_us - edges->rise_us : 0;')),
)
