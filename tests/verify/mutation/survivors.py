# SPDX-License-Identifier: MIT
"""The mutants that mean the same as the code without them, so that no test can see them. A row: why it means the same,
and the identities of those of which this is true, as run.py prints them; space does not count."""
COUNT = 93

ROWS = [
    ('it costs time alone',
     'src/engine/modbus_unit.c | fathom_modbus_unit_poll | condition: (unit->backoff_left_us | unit->warm_us) != 0u '
     '-> 1 | if ((unit->backoff_left_us | unit->warm_us) != 0u)',
     'src/engine/line.c | begin_turn | logical: (pause_us > FATHOM_LINE_LATE_US) && fathom_line_is_old(line, '
     'pause_us) -> fathom_line_is_old(line, pause_us) | if ((pause_us > FATHOM_LINE_LATE_US) && '
     'fathom_line_is_old(line, pause_us))',
     'src/engine/line.c | begin_turn | relational: > -> >= | if ((pause_us > FATHOM_LINE_LATE_US) && '
     'fathom_line_is_old(line, pause_us))',
     'src/engine/line.c | begin_turn | constant: FATHOM_LINE_LATE_US -> (FATHOM_LINE_LATE_US - 1) | if ((pause_us > '
     'FATHOM_LINE_LATE_US) && fathom_line_is_old(line, pause_us))',
     'src/engine/line.c | begin_turn | constant: FATHOM_LINE_LATE_US -> 0 | if ((pause_us > FATHOM_LINE_LATE_US) && '
     'fathom_line_is_old(line, pause_us))'),
    ('no byte is passed, so it does not matter from where',
     'src/engine/line.c | fathom_line_flush | constant: 0 -> 1 | fathom_line_pass(line, 0, 0)',
     'src/engine/line.c | report_loss | constant: 0 -> 1 | fathom_line_pass(line, 0, 0)'),
    ('the amount of this event is not used',
     'src/engine/line_attempt.c | fathom_line_end_attempt | constant: 0 -> 1 | fathom_line_note_sender(line, '
     'SENDER_LOSS, 0)',
     'src/engine/line_response.c | serve | constant: 0 -> 1 | fathom_line_note_sender(line, SENDER_RESPONSE, 0)',
     'src/engine/line_response.c | take_echo | constant: 0 -> 1 | fathom_line_note_sender(line, SENDER_ECHO, 0)',
     'src/engine/line_response.c | take_frame | constant: 0 -> 1 | fathom_line_note_sender(line, '
     'SENDER_FRAME, 0)'),
    ('more than one byte is needed either way',
     'src/engine/line_masters.c | form_of | logical: (frame[0] == DYP_START) && (have > 1u) -> (frame[0] == '
     'DYP_START) | const bool is_dyp = (frame[0] == DYP_START) && (have > 1u) && (frame[1] == DYP_SECOND_START)'),
    ('no pause is as long as that',
     'src/engine/line.c | fathom_line_is_old | constant: FATHOM_NO_DEADLINE -> (FATHOM_NO_DEADLINE - 1) | uint32_t '
     'limit_us = FATHOM_NO_DEADLINE'),
    ('each attempt sets `copy`, so after one no echo of a cancelled request is due',
     'src/engine/line_request.c | advance | jump dropped: it -> nothing | case FATHOM_LINE_WAITING : break',
     'src/engine/line_request.c | advance | logical: is_echo_due(line) && (fathom_line_gap_left_us(line) == 0u) -> '
     '(fathom_line_gap_left_us(line) == 0u) | if (is_echo_due(line) && (fathom_line_gap_left_us(line) == 0u))'),
    ('0 has returned in the line before',
     'src/engine/line_request.c | send_next | relational: < -> <= | if (settings < 0)',
     'src/engine/line_request.c | send_next | constant: 0 -> 1 | if (settings < 0)'),
    ('fathom_line_poll returns FATHOM_PENDING or an error, never FATHOM_OK',
     'src/sensor/dyp_auto.c | fathom_dyp_auto_take | relational: < -> <= | if ((status < 0) || is_followed(sensor))',
     'src/sensor/dyp_auto.c | fathom_dyp_auto_take | constant: 0 -> 1 | if ((status < 0) || is_followed(sensor))'),
    ('a frame has four values at most',
     'src/sensor/dyp_auto.c | store_values | type: unsigned -> uint8_t | unsigned left = (stream->length / 2u) - 1u'),
    ('assigns what is there already',
     'src/engine/fair_share.c | count | relational: > -> >= | if (fathom_elapsed_us(now_us, share->since_us) > '
     'silence_us)',
     'src/engine/trigger.c | fathom_trigger_drive | relational: < -> <= | if (trigger->left_us < trigger->low_us)'),
    ('a number that no other state has; they are compared for equality alone',
     'src/engine/line_internal.h |  | constant: 2 -> 3 | SLOT_OVER = 2'),
    ('writes the byte behind the head, which is set right after; the bounds check of the sanitizer builds ends there',
     'src/codec/modbus_rtu.c | fathom_modbus_rtu_parse_request | name: HEAD -> DATA | for (uint8_t i = 0; i != '
     'HEAD; i ++)'),
    ('any error while a setting is confirmed is told as UNCONFIRMED',
     'src/sensor/hps167s_settings.c | look_for_reset | name: FATHOM_ERR_UNCONFIRMED -> FATHOM_ERR_WARMING_UP | '
     'return FATHOM_ERR_UNCONFIRMED',
     'src/sensor/hps167s_settings.c | look | name: FATHOM_ERR_EXCEPTION -> FATHOM_ERR_CHECKSUM | return '
     'FATHOM_ERR_EXCEPTION'),
    ('the call that hears the refusal is the one that ends',
     'src/sensor/hps167s_settings.c | fathom_hps167s_restore_factory_settings | logical: (status == '
     'FATHOM_ERR_UNCONFIRMED) && is_reset_refused(sensor) -> is_reset_refused(sensor) | return ((status == '
     'FATHOM_ERR_UNCONFIRMED) && is_reset_refused(sensor)) ? FATHOM_ERR_EXCEPTION : status'),
    ('no pair of switches either',
     'src/sensor/hps167s_info.c | be_wary | constant: NOTHING -> (NOTHING + 1) | sensor->last_measurement[0] = '
     'NOTHING',
     'src/sensor/hps167s_info.c | be_wary | constant: NOTHING -> (NOTHING - 1) | sensor->last_measurement[0] = '
     'NOTHING'),
    ('symmetric',
     'src/sensor/dyp_auto.c | fathom_dyp_auto_due_us | arguments: fathom_line_due_us(line), '
     'rest_us(stream->listener.stale_us, passed_us) -> rest_us(stream->listener.stale_us, passed_us), '
     'fathom_line_due_us(line) | return least_us(fathom_line_due_us(line), rest_us(stream->listener.stale_us, '
     'passed_us))',
     'src/engine/line_due.c | fathom_line_due_us | arguments: phase_due_us(line, passed_us), '
     'fathom_line_frame_over_us(line) -> fathom_line_frame_over_us(line), phase_due_us(line, passed_us) | uint32_t '
     'due_us = least_us(phase_due_us(line, passed_us), fathom_line_frame_over_us(line))',
     'src/codec/modbus_rtu.c | fathom_modbus_rtu_is_request | arguments: bytes, message->head -> message->head, '
     'bytes | return is_alike(bytes, message->head, (have < HEAD) ? have : HEAD)',
     'src/codec/modbus_rtu.c | fathom_modbus_rtu_parse_response | arguments: frame + FIRST, head + FIRST -> head + '
     'FIRST, frame + FIRST | if (!is_alike(frame + FIRST, head + FIRST, HEAD - FIRST))',
     'src/sensor/hps167s_info.c | is_believed | arguments: values, sensor->last_measurement -> '
     'sensor->last_measurement, values | if (!fathom_hps167s_may_be_configuration(values) || same_4(values, '
     'sensor->last_measurement))',
     'src/sensor/hps167s_info.c | is_believed | arguments: values, sensor->last_configuration -> '
     'sensor->last_configuration, values | if (!same_4(values, sensor->last_configuration))',
     'src/sensor/a16_controlled.c | fathom_a16_controlled_sensor_due_us | arguments: '
     'fathom_trigger_due_us(trigger, until_us), '
     'fathom_line_due_us(sensor->line) -> fathom_line_due_us(sensor->line), fathom_trigger_due_us(trigger, '
     'until_us) | return least_us(fathom_trigger_due_us(trigger, until_us), fathom_line_due_us(sensor->line))',
     'src/sensor/hps167s_info.c | is_new | arguments: sensor->measurement, sensor->last_configuration -> '
     'sensor->last_configuration, sensor->measurement | if (same_4(sensor->measurement, sensor->last_configuration))'),
    ('at most 9 * 255',
     'src/codec/hps167s_registers.c | fathom_hps167s_temperature_dc | type: int32_t -> int16_t | const int32_t '
     'divisor = 9 * (int32_t) steps_per_degree'),
    ('a dividend of 0 gives 0 either way',
     'src/codec/hps167s_registers.c | fathom_hps167s_temperature_dc | relational: >= -> > | return ((dividend >= 0) '
     '? (dividend + (divisor / 2)) : (dividend - (divisor / 2))) / divisor',
     'src/codec/hps167s_registers.c | fathom_hps167s_temperature_dc | constant: 0 -> 1 | return ((dividend >= 0) ? '
     '(dividend + (divisor / 2)) : (dividend - (divisor / 2))) / divisor'),
    ('looks at the byte when the next one has come; what is taken is the same',
     'src/sensor/hps167s_auto.c | has_head | name: FUNCTION -> SIZE | if ((held_count > FUNCTION) && '
     '(bytes[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS))'),
    ('a number that no other step has; they are compared for equality alone',
     'src/engine/modbus_setting.c |  | constant: 5 -> 6 | WRITE_UNREAD = 5',
     'src/sensor/hps167s_settings.c |  | constant: 1 -> 2 | WRITE_ONLY = 1'),
    ("no write's name: they have the highest bit",
     'src/sensor/hps167s_settings.c | set_all | constant: 0 -> 1 | unit->last_written = 0'),
    ('an int of 32 bits holds what is shifted; the tests on an int of 16 bits see it',
     'src/codec/hps167s_registers.c | fathom_hps167s_decode_reconnect_time | type: uint32_t -> uint16_t | return '
     'low_word_first ? (((uint32_t) second << 16) | first) : (((uint32_t) first << 16) | second)',
     'src/codec/hps167s_registers.c | fathom_hps167s_decode_reconnect_time | type: uint32_t -> uint16_t | return '
     'low_word_first ? (((uint32_t) second << 16) | first) : (((uint32_t) first << 16) | second) | 2'),
    ('an int of 32 bits holds the sum or the product',
     'src/processing/median.c | is_spike | type: uint32_t -> uint16_t | const uint32_t gate_mm = median->config.gate_mm',
     'src/processing/level.c | area_below | type: uint32_t -> uint16_t | const uint32_t square = (uint32_t) x * g | 2',
     'src/processing/level.c | area_below | type: uint32_t -> uint16_t | return ((uint32_t) x * root) >> 15'),
    ('every root over 0 is reached from 1 too, and one of 0 is multiplied by 0',
     'src/processing/level.c | area_below | constant: 0 -> 1 | uint16_t root = 0'),
    ('both ways give exactly half there',
     'src/processing/level.c | fathom_tank_horizontal_cylinder | relational: > -> >= | const uint32_t area = (x > HALF) '
     '? (ONE - area_below((uint16_t) (ONE - x))) : area_below((uint16_t) x)',
     'src/processing/level.c | fathom_tank_horizontal_cylinder | constant: HALF -> (HALF - 1) | const uint32_t area = '
     '(x > HALF) ? (ONE - area_below((uint16_t) (ONE - x))) : area_below((uint16_t) x)'),
    ('the bound itself is what it is set to',
     'src/engine/modbus_unit.c | back_off | relational: < -> <= | for (uint8_t n = unit->timeouts_in_row; (n != '
     'PATIENCE) && (wait_us < unit->backoff_us); n --)',
     'src/processing/level.c | fathom_level_from_distance | relational: > -> >= | if (level_mm > 0)',
     'src/processing/level.c | fathom_level_from_distance | relational: < -> <= | inside_mm = (level_mm < (int32_t) height_mm) ? '
     '(uint16_t) level_mm : height_mm'),
    ('set by the read, and not looked at after a write',
     'src/engine/modbus_setting.c | fathom_modbus_set | constant: 0 -> 1 | uint32_t value = 0'),
    ('the register is not sent; the function alone is looked at',
     'src/engine/dyp_client.c |  | constant: 0x0200 -> 0x0000 | ADDRESS_REGISTER = 0x0200',
     'src/engine/dyp_client.c |  | constant: 0x0200 -> 0x01FF | ADDRESS_REGISTER = 0x0200',
     'src/engine/dyp_client.c |  | constant: 0x0200 -> 0x0201 | ADDRESS_REGISTER = 0x0200',
     'src/engine/dyp_client.c | fathom_dyp_client_broadcast_address | arguments: ADDRESS_REGISTER, address -> '
     'address, ADDRESS_REGISTER | fathom_modbus_write_single_register(& request->message, address, '
     'ADDRESS_REGISTER, address)'),
    ('AA alone is a second probe at 43520 mm or more too, which no A05 measures',
     'src/engine/dyp_client.c | check | logical: (length == FATHOM_DYP_MAX_RESPONSE) && (frame[NEXT] == frame[0]) '
     '-> (length == FATHOM_DYP_MAX_RESPONSE) | if ((length == FATHOM_DYP_MAX_RESPONSE) && (frame[NEXT] == frame[0]) '
     '&& (frame[NEXT + 1] == frame[1]) && fathom_dyp_55aa_is_valid(frame, NEXT))'),
    ('writes a value behind the last, which no code reads; the bounds check of the sanitizer builds ends there',
     'src/sensor/a16_controlled.c | judge | constant: 1 -> 2 | fathom_dyp_stream_decode(fathom_stream_frame(& '
     'sensor->stream), response->values, 1)'),
    ('neither NEAR nor FAR',
     'src/engine/contact.c | fathom_contact_init | constant: 0 -> 1 | contact->last_kind = 0'),
    ('set before it is looked at',
     'src/sensor/dyp_modbus.c | fathom_dyp_modbus_get_address | constant: 0 -> 1 | uint16_t value = 0',
     'src/sensor/a16_settings.c | get_choice | constant: 0 -> 1 | uint16_t found = 0'),
    ('the distance is not looked at',
     'src/sensor/a05_dyp.c | read_address | type: uint16_t -> uint8_t | uint16_t distance = 0',
     'src/sensor/a05_dyp.c | read_address | constant: 0 -> 1 | uint16_t distance = 0'),
    ('looked at only while it listens, and is set when that begins',
     'src/sensor/a16_rs232.c | fathom_a16_rs232_init | statement dropped: it -> nothing | rs232->since_us = 0',
     'src/sensor/a16_rs232.c | fathom_a16_rs232_init | constant: 0 -> 1 | rs232->since_us = 0',
     'src/sensor/a16_rs232.c | fathom_a16_rs232_init | statement dropped: it -> nothing | rs232->polled_us = 0',
     'src/sensor/a16_rs232.c | fathom_a16_rs232_init | constant: 0 -> 1 | rs232->polled_us = 0'),
    ('the callers give a variable of their own, and copy it where the status, which is told either way, is READY',
     'src/sensor/a16_settings.c | get_choice | condition: status != FATHOM_OK -> 0 | if (status != FATHOM_OK)',
     'src/sensor/a16_settings.c | get_choice | jump dropped: it -> nothing | if (status != FATHOM_OK) return '
     'status'),
    ('more than 65535 mm either way, which is what is said',
     'src/codec/pulse_width.c | fathom_pulse_width_mm | constant: LONGEST_US -> (LONGEST_US - 1) | return '
     'bounded_mm(((least(width_us, LONGEST_US) * 100u) + (us_per_dm / 2u)) / us_per_dm)',
     'src/codec/pulse_width.c | fathom_pulse_width_mm | constant: LONGEST_US -> (LONGEST_US + 1) | return '
     'bounded_mm(((least(width_us, LONGEST_US) * 100u) + (us_per_dm / 2u)) / us_per_dm)',
     'src/codec/pulse_width.c | fathom_pulse_width_mm_in_air | constant: LONGEST_IN_AIR_US -> (LONGEST_IN_AIR_US - 1) '
     '| const uint32_t us = least(width_us, LONGEST_IN_AIR_US)',
     'src/codec/pulse_width.c | fathom_pulse_width_mm_in_air | constant: LONGEST_IN_AIR_US -> (LONGEST_IN_AIR_US + 1) '
     '| const uint32_t us = least(width_us, LONGEST_IN_AIR_US)'),
    ('what is not in mm is in the rest',
     'src/codec/pulse_width.c | fathom_pulse_width_mm_in_air | constant: 20000u -> 20001u | const uint32_t mm = '
     'high / 20000u'),
    ('the speed is even, so that no product ends in 9999999',
     'src/codec/pulse_width.c | fathom_pulse_width_mm_in_air | constant: 10000000u -> 10000001u | return '
     'bounded_mm(mm + ((rest + 10000000u) / 20000000u))'),
    ('looked at only while there is a candidate, which sets it',
     'src/engine/stream.c | fathom_stream_start | statement dropped: it -> nothing | stream->candidate_us = now_us'),
    ('compared with 0 alone',
     'src/engine/dyp_client.c | check | constant: 1 -> 2 | return 1'),
    ('what begins like no frame is dropped when its fifth byte has come, or at the gap, or earlier',
     'src/engine/dyp_client.c | is_request | logical: (have < NEXT) || ((frame[ADDRESS] == head[0]) && '
     '(frame[COMMAND] == command_of(head))) -> ((frame[ADDRESS] == head[0]) && (frame[COMMAND] == '
     'command_of(head))) | return (have < NEXT) || ((frame[ADDRESS] == head[0]) && (frame[COMMAND] == '
     'command_of(head)))',
     'src/engine/dyp_client.c | is_request | name: NEXT -> ADDRESS | return (have < NEXT) || ((frame[ADDRESS] == '
     'head[0]) && (frame[COMMAND] == command_of(head)))'),
    ('writes the two bytes behind the UUID, the year, which is set right after; the bounds check of the sanitizer '
     'builds ends there',
     'src/codec/hps167s_registers.c | fathom_hps167s_decode_details | name: FATHOM_HPS167S_UUID_LENGTH -> '
     'FATHOM_HPS167S_RECONNECT_STEP_MS | for (uint8_t i = 0; i != FATHOM_HPS167S_UUID_LENGTH; i ++)'),
    ('0 either way',
     'src/common.h | rest_us | relational: <= -> < | if (us <= passed_us)'),
    ('the one fitted probe, which is told either way',
     'src/sensor/a05_auto.c | odd_probe | relational: <= -> < | for (uint8_t bit = 1; bit <= sensor->probes; bit = '
     '(uint8_t) (bit << 1))'),
    ('half the range of the clock is 35 minutes, and no program waits so long',
     'src/sensor/a16_rs232.c | is_since | relational: <= -> < | return fathom_elapsed_us(time_us, rs232->since_us) '
     '<= (UINT32_MAX / 2u)'),
    ('unit 0 has not been asked there, and the CRC of one byte 0 is not 0',
     'src/engine/modbus_client.c | length | constant: 0u -> 1u | return (frame[0] != FATHOM_MODBUS_BROADCAST) ? '
     'fathom_modbus_rtu_response_length(frame, have) : 0u'),
    ('copied above already; it is for analysers',
     'src/processing/median.c | fathom_median_init | statement dropped: it -> nothing | own->window = config->window'),
    ('of one of them it is so, before the end is met',
     'src/processing/median.c | middle_of | arithmetic: - -> + | const uint16_t * const last = & at[count - 1u]',
     'src/processing/median.c | middle_of | constant: 1u -> 0u | const uint16_t * const last = & at[count - 1u]',
     'src/processing/median.c | middle_of | condition: at < last -> 1 | for (; at < last; at ++)',
     'src/processing/median.c | middle_of | relational: < -> <= | for (; at < last; at ++)'),
]

assert sum(len(row) - 1 for row in ROWS) == COUNT
