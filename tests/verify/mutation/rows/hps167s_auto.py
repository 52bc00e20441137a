# SPDX-License-Identifier: MIT
ROWS = (
    ('drops-all', 'hps167s_auto.h: it finds its way back byte by byte', 'unit/test_hps167s_auto',
     ('src/sensor/hps167s_auto.c', 'receive',
      'while ((sensor->have != 0u) && !fits(sensor)) slip(sensor);',
      'if (!fits(sensor)) sensor->have = 0; if (sensor->have > LENGTH) slip(sensor);')),
)
