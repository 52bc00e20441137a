# SPDX-License-Identifier: MIT
ROWS = (
    ('fahrenheit-without-sign', 'hps167s_info.h #4: int16', 'unit/test_hps167s_info',
     ('src/hps167s_info.c', 'fathom_hps167s_temperature',
      'const int16_t raw = (int16_t)(bits < 0x8000u ? (int32_t)bits : (int32_t)bits - 0x10000);',
      'const int16_t raw = (int16_t)(bits & 0x7FFFu);')),
    ('uuid-shifted', 'hps167s_info.h #3: 16 bytes in the order of the wire', 'unit/test_hps167s',
     ('src/hps167s_info.c', 'fathom_hps167s_details',
      'out->uuid[i] = low(*values++); out->uuid[i + 1] = high(*values);',
      'out->uuid[i] = high(*values); out->uuid[i + 1] = low(*values++);')),
)
