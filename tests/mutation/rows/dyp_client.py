# SPDX-License-Identifier: MIT
ROWS = (
    ('unit-not-compared', "line.h: another unit's answer is not taken", 'unit/test_dyp_client',
     ('src/dyp_client.c', 'judge',
      'match->unit = frame[ADDRESS < have ? ADDRESS : 0];',
      'match->unit = exchange != NULL ? exchange->unit : frame[ADDRESS < have ? ADDRESS : 0];')),
)
