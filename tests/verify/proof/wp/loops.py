# SPDX-License-Identifier: MIT
"""Invariants of the codecs' loops: a source, a function, how its loop begins (by tokens; it is there once), and what
stands before it."""
SUM = '''loop invariant 0 <= length <= \\at(length, Pre) && bytes == \\at(bytes, Pre) + (\\at(length, Pre) - length);
    loop invariant sum == sum_of(\\at(bytes, Pre), \\at(length, Pre) - length);
    loop assigns length, bytes, sum;
    loop variant length;'''

ROWS = (
    ('dyp_stream', 'fathom_dyp_checksum', 'for (; length != 0u; length--)', SUM),
    ('dyp_stream', 'fathom_dyp_stream_is_valid', 'for (length--; length != 0u;', '''
    loop invariant 0 <= length < \\at(length, Pre) && frame == \\at(frame, Pre) + (\\at(length, Pre) - 1 - length);
    loop invariant sum == sum_of(\\at(frame, Pre), \\at(length, Pre) - 1 - length);
    loop assigns length, frame, sum;
    loop variant length;'''),
    ('dyp_stream', 'fathom_dyp_stream_decode', 'for (frame++; probes != 0u;', '''
    loop invariant 0 <= probes <= \\at(probes, Pre);
    loop invariant frame == \\at(frame, Pre) + 1 + 2 * (\\at(probes, Pre) - probes);
    loop invariant values == \\at(values, Pre) + (\\at(probes, Pre) - probes);
    loop invariant registers(\\at(frame, Pre) + 1, \\at(values, Pre), \\at(probes, Pre) - probes);
    loop assigns probes, frame, values, \\at(values, Pre)[0 .. \\at(probes, Pre) - 1];
    loop variant probes;'''),
    ('dyp_stream', 'fathom_dyp_stream_encode', 'for (; probes != 0u;', '''
    loop invariant 0 <= probes <= \\at(probes, Pre);
    loop invariant values == \\at(values, Pre) + (\\at(probes, Pre) - probes);
    loop invariant length == 1 + 2 * (\\at(probes, Pre) - probes);
    loop invariant frame[0] == 0xFF;
    loop invariant registers(frame + 1, \\at(values, Pre), \\at(probes, Pre) - probes);
    loop assigns probes, values, length, frame[1 .. 2 * \\at(probes, Pre)];
    loop variant probes;'''),
    ('dyp_55aa', 'fathom_dyp_55aa_encode_response', 'for (uint8_t left =', '''
    loop invariant 0 <= left <= values_of(command);
    loop invariant values == \\at(values, Pre) + (values_of(command) - left);
    loop invariant at == frame + 4 + 2 * (values_of(command) - left);
    loop invariant begins_with(frame, address, command);
    loop invariant registers(frame + 4, \\at(values, Pre), values_of(command) - left);
    loop assigns left, values, at, frame[4 .. 3 + 2 * values_of(command)];
    loop variant left;'''),
    ('modbus_rtu', 'put_values', 'for (; count != 0u;', '''
    loop invariant 0 <= count <= \\at(count, Pre) && values == \\at(values, Pre) + (\\at(count, Pre) - count);
    loop invariant at == \\at(at, Pre) + 2 * (\\at(count, Pre) - count);
    loop invariant registers(\\at(at, Pre), \\at(values, Pre), \\at(count, Pre) - count);
    loop assigns count, values, at, \\at(at, Pre)[0 .. 2 * \\at(count, Pre) - 1];
    loop variant count;'''),
    ('modbus_rtu', 'get_values', 'for (; count != 0u;', '''
    loop invariant 0 <= count <= \\at(count, Pre) && values == \\at(values, Pre) + (\\at(count, Pre) - count);
    loop invariant at == \\at(at, Pre) + 2 * (\\at(count, Pre) - count);
    loop invariant registers(\\at(at, Pre), \\at(values, Pre), \\at(count, Pre) - count);
    loop assigns count, values, at, \\at(values, Pre)[0 .. \\at(count, Pre) - 1];
    loop variant count;'''),
    ('modbus_rtu', 'put_head', 'do {', '''
    loop invariant 0 <= at - \\at(at, Pre) <= 5 && at == \\at(at, Pre) + (at - \\at(at, Pre));
    loop invariant from == &message->head[0] + (at - \\at(at, Pre));
    loop invariant same_head(\\at(at, Pre), &message->head[0], at - \\at(at, Pre));
    loop assigns at, from, \\at(at, Pre)[0 .. 5];
    loop variant 6 - (at - \\at(at, Pre));'''),
    ('modbus_rtu', 'is_alike', 'for (; count != 0u;', '''
    loop invariant 0 <= count <= \\at(count, Pre);
    loop invariant a == \\at(a, Pre) + (\\at(count, Pre) - count);
    loop invariant b == \\at(b, Pre) + (\\at(count, Pre) - count);
    loop invariant same_head((uint8_t *)\\at(a, Pre), (uint8_t *)\\at(b, Pre), \\at(count, Pre) - count);
    loop assigns count, a, b;
    loop variant count;'''),
    ('modbus_rtu', 'fathom_modbus_rtu_parse_request', 'for (uint8_t i = 0', '''
    loop invariant 0 <= i <= 6 && same_head(&message->head[0], (uint8_t *)frame, i);
    loop assigns i, message->head[0 .. 5];
    loop variant 6 - i;'''),
    ('modbus_rtu', 'fathom_modbus_rtu_encode_response', 'return seal(frame, at)', '''
    assert end: message->exception == 0 && message->head[1] == 3 ==> at == frame + 3 + 2 * message->head[5];
    assert head: message->exception == 0 && message->head[1] == 3 ==> frame[1] == 3 &&
        frame[2] == 2 * message->head[5];
    assert data: message->exception == 0 && message->head[1] == 3 ==>
        registers(frame + 3, message->values, message->head[5]);
    assert sent: message->exception == 0 && message->head[1] != 3 ==>
        at == frame + 6 && same_six(frame, &message->head[0]);'''),
    ('modbus_rtu', 'fathom_modbus_rtu_encode_request', 'return seal(frame, at)', '''
    assert sent: same_head(frame, &message->head[0], 6);'''),
    ('crc16', 'fathom_crc16', 'for (; length != 0u;', '''
    loop invariant 0 <= length <= \\at(length, Pre) && bytes == \\at(bytes, Pre) + (\\at(length, Pre) - length);
    loop invariant 0 <= crc <= 0xFFFF;
    loop invariant crc == crc_of(\\at(bytes, Pre), \\at(length, Pre) - length);
    loop assigns length, bytes, crc;
    loop variant length;'''),
    ('crc16_small', 'fathom_crc16', 'for (; length != 0u;', '''
    loop invariant 0 <= length <= \\at(length, Pre) && bytes == \\at(bytes, Pre) + (\\at(length, Pre) - length);
    loop invariant 0 <= crc <= 0xFFFF;
    loop invariant crc == crc_of(\\at(bytes, Pre), \\at(length, Pre) - length);
    loop assigns length, bytes, crc;
    loop variant length;'''),
    ('hps167s_registers', 'fathom_hps167s_baud_code', 'while ((code != 0u)', '''
    loop invariant 0 <= code <= 4;
    loop invariant code < 4 ==> baud != 230400;
    loop invariant code < 3 ==> baud != 115200;
    loop invariant code < 2 ==> baud != 57600;
    loop invariant code < 1 ==> baud != 19200;
    loop assigns code;
    loop variant code;'''),
    ('hps167s_registers', 'fathom_hps167s_decode_details', 'for (uint8_t i = 0', '''
    loop invariant 0 <= i <= 16;
    loop invariant \\forall integer j; 0 <= j < i ==> details->uuid[j] == byte_of((uint16_t *)registers, 1 + j);
    loop assigns i, details->uuid[0 .. 15];
    loop variant 16 - i;'''),
    ('crc16', 'fathom_crc16', 'crc = (crc >> 8)', '''
    assert range: 0 <= crc_step(crc, *bytes) <= 0xFFFF;
    assert within: 0 <= (crc ^ *bytes) <= 0xFFFF;
    assert entry: table[(crc ^ *bytes) & 0xFF] == entry((crc ^ *bytes) & 0xFF);
    assert step: STEP(crc, *bytes) == crc_step(crc, *bytes);'''),
    ('crc16_small', 'fathom_crc16', 'crc ^= *bytes', '''
    assert range: 0 <= crc_step(crc, *bytes) <= 0xFFFF;
    assert within: 0 <= (crc ^ *bytes) <= 0xFFFF;
    assert half: 0 <= HALF_STEP(crc ^ *bytes) <= 0xFFFF;
    assert step: STEP(crc, *bytes) == crc_step(crc, *bytes);'''),
    ('pulse_width', 'fathom_pulse_width_mm_in_air', 'const uint32_t mm =', '''
    assert speed: v == speed(\\at(air_dc, Pre));
    assert product: us * v == 1000 * high + low;'''),
    ('pulse_width', 'fathom_pulse_width_mm_in_air', 'return bounded_mm(', '''
    assert parts: us * v == 20000000 * mm + ((high - (mm * 20000)) * 1000 + low);
    assert whole: (us * v + 10000000) / 20000000 == mm + (rest + 10000000) / 20000000;
    assert long: \\at(width_us, Pre) >= 500000 ==> v * \\at(width_us, Pre) >= v * 500000;'''),
)
