# SPDX-License-Identifier: MIT
"""Faults that wp.py --self-test plants: a name, the unit that has to see it, a file, a function ('' where it is no C
source), the old text, which is there once, the new one, and the function whose goals see it."""
DYP, AA, PULSE = (f'src/codec/{name}.c' for name in ('dyp_stream', 'dyp_55aa', 'pulse_width'))
CRC, SMALL, RTU, HPS = (f'src/codec/{name}.c' for name in ('crc16', 'crc16_small', 'modbus_rtu', 'hps167s_registers'))
ROUND_DYP, ROUND_MODBUS = (f'tests/verify/proof/wp/{name}.c' for name in ('round_dyp', 'round_modbus'))

ROWS = (
    ('dyp_stream: sum over a byte too few', 'dyp_stream', DYP, 'fathom_dyp_stream_encode',
     'fathom_dyp_sum(frame, length)', 'fathom_dyp_sum(frame, (uint8_t)(length - 1u))', 'fathom_dyp_stream_encode'),
    ('dyp_stream: high and low swapped', 'dyp_stream', DYP, 'fathom_dyp_stream_decode',
     '(frame[0] * 256u) + frame[1]', '(frame[1] * 256u) + frame[0]', 'fathom_dyp_stream_decode'),
    ('dyp_55aa: sum over a byte too few', 'dyp_55aa', AA, 'fathom_dyp_55aa_valid',
     'fathom_dyp_sum(frame, last)', 'fathom_dyp_sum(frame, (uint8_t)(last - 1u))', 'fathom_dyp_55aa_valid'),
    ('dyp_55aa: a probe too many', 'dyp_55aa', AA, 'fathom_dyp_55aa_values',
     'return FATHOM_DYP_PROBES;', 'return FATHOM_DYP_PROBES + 1;', 'fathom_dyp_55aa_values'),
    ('pulse_width: rounded down', 'pulse_width', PULSE, 'fathom_pulse_width_mm', '11u', '0u',
     'fathom_pulse_width_mm'),
    ('crc16: an entry of the table', 'crc16', CRC, '', '0x9241', '0x9240', 'enumeration'),
    ('crc16_small: an entry of the table', 'crc16_small', SMALL, '', '0x6C00', '0x6C01', 'enumeration'),
    ('crc16: another beginning', 'crc16', CRC, 'fathom_crc16', 'crc = 0xFFFF', 'crc = 0', 'fathom_crc16'),
    ('crc16_small: a nibble only', 'crc16_small', SMALL, 'fathom_crc16', 'bytes++; crc = (crc >> 4) ^ table[crc & 15u];',
     'bytes++;', 'fathom_crc16'),
    ('modbus_rtu: CRC over a byte too few', 'modbus_rtu', RTU, 'seal', 'fathom_crc16(frame, length)',
     'fathom_crc16(frame, (uint8_t)(length - 1u))', 'seal'),
    ('modbus_rtu: CRC with its high byte first', 'modbus_rtu', RTU, 'seal', 'frame[length] = (uint8_t)crc;',
     'frame[length] = (uint8_t)(crc >> 8);', 'seal'),
    ('modbus_rtu: values of a refused response', 'modbus_rtu', RTU, 'fathom_modbus_rtu_parse_response',
     'if (frame[SIZE] != (2u * count)) return FATHOM_ERR_MALFORMED; '
     'get_values(message->values, &frame[SIZE + 1], count);',
     'get_values(message->values, &frame[SIZE + 1], count); '
     'if (frame[SIZE] != (2u * count)) return FATHOM_ERR_MALFORMED;',
     'fathom_modbus_rtu_parse_response'),
    ('hps167s_registers: words of the reconnect time swapped', 'hps167s_registers', HPS,
     'fathom_hps167s_reconnect_time_ms', 'return low_word_first ?', 'return !low_word_first ?',
     'fathom_hps167s_reconnect_time_ms'),
    ('hps167s_registers: an exponent too many', 'hps167s_registers', HPS, 'fathom_hps167s_decode_within',
     '(exponent > FATHOM_HPS167S_MAX_EXPONENT)', '(exponent > (FATHOM_HPS167S_MAX_EXPONENT + 1))',
     'fathom_hps167s_decode_within'),
    ('hps167s_registers: temperature rounded towards zero', 'hps167s_registers', HPS, 'fathom_hps167s_temperature_dc',
     '(dividend + (divisor / 2))', 'dividend', 'fathom_hps167s_temperature_dc'),
    ('round_dyp: a probe too few', 'round_dyp', ROUND_DYP, 'stream', 'fathom_dyp_stream_decode(frame, back, probes)',
     'fathom_dyp_stream_decode(frame, back, (uint8_t)(probes / 2u))', 'stream'),
    ('round_modbus: CRC without its last byte', 'round_modbus', ROUND_MODBUS, 'accepted', 'fathom_crc16(frame, length)',
     'fathom_crc16(frame, (uint8_t)(length - 1u))', 'accepted'),
    ('round_modbus: a register too few', 'round_modbus', ROUND_MODBUS, 'write_request', '(got, frame, 123)',
     '(got, frame, 122)', 'write_request'),
    ('contract that contradicts itself', 'pulse_width', 'tests/verify/proof/wp/pulse_width.h', '',
     '/*@ assigns \\nothing;\n    ensures \\result == up_to(mm);',
     '/*@ requires mm < 10 && mm > 10;\n    assigns \\nothing;\n    ensures \\result == up_to(mm);', 'bounded_mm'),
)
