# SPDX-License-Identifier: MIT
ROWS = (
    ('implausible-probe-passes', 'dyp_auto.h: where its place is not sure a frame with an odd probe is no frame',
     'unit/test_a05_auto',
     ('src/dyp_auto.c', 'believed', 'odd == 0 || (', 'true || (')),
    ('unsure-place-passes', 'dyp_auto.h: the same, after a frame with an odd probe',
     'unit/test_a05_auto',
     ('src/dyp_auto.c', 'believed', 'sensor->stream.sure && sensor->was_odd', 'sensor->was_odd')),
    ('newly-odd-passes', 'dyp_auto.h: a frame in which a probe turns odd may be damaged',
     'unit/test_a05_auto',
     ('src/dyp_auto.c', 'believed', 'sensor->stream.sure && sensor->was_odd', 'sensor->stream.sure')),
)
