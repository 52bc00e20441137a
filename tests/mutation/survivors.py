# SPDX-License-Identifier: MIT
"""The mutants that mean the same as the code without them, so that no test can see them. A row: why it means the same,
and the identities of those of which this is true, as run.py prints them; space does not count."""
COUNT = 182  # of the identities; a row that is added changes it

ROWS = [
    ('`need` is compared with `have` alone, which is not 0 then',
     'src/line_receive.c | drop | constant: 0 -> 1 | line->need = 0',
     'src/line.c | broken | constant: 0 -> 1 | line->need = 0',
     'src/line.c | fathom_line_init | constant: 0 -> 1 | line->need = 0'),
    ('the second of two defences: the protocol compares the unit too, and either is enough',
     'src/line_receive.c | deliver_late | logical: x->attempts == 0 || (x->unit != unit && x->unit != '
     'FATHOM_LINE_ANY_UNIT) -> x->attempts == 0 | if (x->attempts == 0 || (x->unit != unit && x->unit != '
     'FATHOM_LINE_ANY_UNIT))',
     'src/dyp_client.c | answer | name: FATHOM_PENDING -> FATHOM_READY | return FATHOM_PENDING'),
    ('a frame that equals its request comes here only with ECHOED set, or where there is no echo already',
     'src/line_receive.c | take | logical: !is_request && (line->state & (uint8_t) ~(PHASE | ANSWERED_WRONG)) == 0 -> '
     '(line->state & (uint8_t) ~(PHASE | ANSWERED_WRONG)) == 0 | const bool is_first = !is_request && (line->state & '
     '(uint8_t) ~(PHASE | ANSWERED_WRONG)) == 0'),
    ('no frame is of the unit that all are asked by: that of unit 0 has another name there',
     'src/line_receive.c | asked | logical: line->state > REFUSED && is_answered(line->head) -> line->state > REFUSED | '
     'return line->state > REFUSED && is_answered(line->head) ? line->head : NULL'),
    ('it costs time alone',
     'src/line_inside.h | look | logical: line->owing != 0 && fathom_run_down(& line->owed_us, passed_us) -> '
     'fathom_run_down(& line->owed_us, passed_us) | if (line->owing != 0 && fathom_run_down(& line->owed_us, '
     'passed_us))'),
    ("`request` is set only by the bytes of this exchange's own request, its unit included",
     'src/line_receive.c | judge | logical: is_asked && match->request != 0 -> match->request != 0 | if (is_asked && '
     'match->request != 0)'),
    ('no whole frame of a protocol is as short as LEAST_TORN',
     'src/line_receive.c | judge | logical: is_whole || line->have >= LEAST_TORN -> line->have >= LEAST_TORN | if '
     '(is_whole || line->have >= LEAST_TORN)'),
    ("a byte's difference, and never negative",
     'src/line_receive.c | fathom_line_read | type: size_t -> uint8_t | int n = uart->read(uart->ctx, config->frame '
     '+ line->have, (size_t) (config->frame_size - line->have), & rx)'),
    ('assigns what is there already',
     'src/line.c | fathom_line_owe | relational: < -> <= | if (line->owing == 0 || line->owed_us < longest_us)',
     'src/pulse.c | release | relational: < -> <= | if (meter->left_us < low_us(meter->config))',
     'src/a16_controlled.c | release | relational: < -> <= | if (sensor->left_us < sensor->low_us)',
     'src/a05_dyp.c | fathom_a05_dyp_init | relational: > -> >= | if (config->period_us > question->pace_us)',
     'src/hps167s_info.c | is_believed | relational: < -> <= | if (is_among_unasked && needed < '
     'ANSWERS_AMONG_UNASKED)'),
    ('256 would be a mark of LOST on a read of no byte, which is never made',
     'src/line.c | receive | name: COUNT_READ -> LOST | if (came > COUNT_READ)',
     'src/line_inside.h |  | constant: 0x0FF -> 0x100 | COUNT_READ = 0x0FF'),
    ('a scan of no bytes does nothing; the question is there for speed',
     'src/line.c | receive | logical: line->have != 0 && line->silent_us >= gap_us(line) -> line->silent_us >= '
     'gap_us(line) | if (line->have != 0 && line->silent_us >= gap_us(line))'),
    ('sets the time that is left, which nobody looks at while nothing is on the wire',
     'src/line.c | fathom_line_init | statement dropped: it -> nothing | line->left_us = 0',
     'src/line.c | fathom_line_init | constant: 0 -> 1 | line->left_us = 0'),
    ('set by the first request, before which no unit can owe an answer',
     'src/line.c | fathom_line_init | statement dropped: it -> nothing | line->protocol = NULL'),
    ('while the port sends, the silence is 0, so that nothing else is sent',
     'src/line.c | fathom_line_poll | name: REFUSED -> SENDING | if (line->state <= REFUSED && status == '
     'FATHOM_PENDING)'),
    ('0 either way',
     'src/line.c | still_to_be_silent | relational: > -> >= | return us > line->silent_us ? (uint32_t) (us - '
     'line->silent_us) : 0',
     'src/line.c | fathom_line_due_us | relational: > -> >= | return due_us > passed_us ? due_us - passed_us : 0',
     'src/modbus_unit.c | fathom_modbus_unit_due_us | relational: > -> >= | return unit->state == IDLE && left_us > '
     'passed_us ? left_us - passed_us : 0',
     'src/pulse.c | fathom_pulse_due_us | relational: > -> >= | return due_us > passed_us ? due_us - passed_us : 0',
     'src/a16_controlled.c | due_us | relational: > -> >= | due = due > passed_us ? due - passed_us : 0',
     'src/contact.c | due_us | relational: > -> >= | us = us > passed_us ? us - passed_us : 0',
     'src/a16_rs232.c | fathom_a16_rs232_due_us | relational: < -> <= | const uint32_t left_us = passed_us < '
     'rs232->return_us ? rs232->return_us - passed_us : 0',
     'src/stream.c | silence_left_us | relational: > -> >= | return gap_us > passed_us ? gap_us - passed_us : 0',
     'src/stream.c | fathom_stream_due_us | relational: <= -> < | if (stream->fresh || stream->left_us <= passed_us)'),
    ('both are silences, of 16 bits',
     'src/line.c | still_to_be_silent | type: uint32_t -> uint16_t | return us > line->silent_us ? (uint32_t) (us - '
     'line->silent_us) : 0',
     'src/line.c | fathom_line_due_us | type: uint32_t -> uint16_t | const uint32_t rest_us = '
     'still_to_be_silent(line, gap_us(line))'),
    ('a number that no other state has; they are compared for equality alone',
     'src/modbus_unit.c |  | constant: 2 -> 3 | ANSWERED = 2'),
    ('turns one bit of all names, which are compared with each other alone',
     'src/modbus_unit.c | fathom_modbus_unit_name | relational: != -> == | if (question->function != 0)'),
    ('only looked at while a question is under way, whose beginning sets it',
     'src/modbus_unit.c | fathom_modbus_unit_init | statement dropped: it -> nothing | unit->attempts = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | constant: 0 -> 1 | unit->attempts = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | statement dropped: it -> nothing | unit->is_command = false',
     'src/modbus_unit.c | fathom_modbus_unit_init | constant: false -> true | unit->is_command = false',
     'src/modbus_unit.c | fathom_modbus_unit_init | statement dropped: it -> nothing | unit->pace_us = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | constant: 0 -> 1 | unit->pace_us = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | statement dropped: it -> nothing | unit->backoff_us = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | constant: 0 -> 1 | unit->backoff_us = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | statement dropped: it -> nothing | unit->asked = 0',
     'src/modbus_unit.c | fathom_modbus_unit_init | constant: 0 -> 1 | unit->asked = 0'),
    ('writes the byte behind the head, which is set right after; the bounds check of the sanitizer builds ends there',
     'src/modbus_rtu.c | fathom_modbus_rtu_parse_request | name: HEAD -> DATA | for (uint8_t i = 0; i != HEAD; i ++)'),
    ('any error while a setting is confirmed is told as UNCONFIRMED',
     'src/hps167s_settings.c | look_for_reset | name: FATHOM_ERR_UNCONFIRMED -> FATHOM_ERR_WARMING_UP | return '
     'FATHOM_ERR_UNCONFIRMED',
     'src/hps167s_settings.c | look | name: FATHOM_ERR_EXCEPTION -> FATHOM_ERR_CHECKSUM | return '
     'FATHOM_ERR_EXCEPTION'),
    ('fathom_modbus_set() compares the name again',
     'src/hps167s_settings.c | prepare | logical: is_this && wanted[0] == first -> wanted[0] == first | return '
     'is_this && wanted[0] == first && wanted[1] == second ? FATHOM_READY : FATHOM_ERR_BUSY'),
    ('only compared with itself; one register is written',
     'src/hps167s_settings.c |  | constant: 1 -> 2 | TO_ALL = 1',
     'src/hps167s_settings.c | fathom_hps167s_set_address | constant: 0 -> 1 | return set(sensor, & setting, '
     'address, 0)',
     'src/hps167s_settings.c | fathom_hps167s_set_baud | constant: 0 -> 1 | fathom_status_t status = prepare(sensor, '
     '& setting, code, 0)'),
    ('a code is at most 4',
     'src/hps167s_settings.c | fathom_hps167s_set_baud | type: uint16_t -> uint8_t | const uint16_t code = '
     'code_of(baud)'),
    ('only compared with itself; nothing is written',
     'src/hps167s_settings.c | fathom_hps167s_restore_factory_settings | constant: 0 -> 1 | fathom_status_t status = '
     'prepare(sensor, & setting, 0, 0)',
     'src/hps167s_settings.c | fathom_hps167s_restore_factory_settings | constant: 0 -> 1 | fathom_status_t status = '
     'prepare(sensor, & setting, 0, 0) | 2'),
    ('once it has begun, the address is looked at only where the device was before',
     'src/hps167s_settings.c | fathom_hps167s_restore_factory_settings | condition: begins -> 1 | if ((begins ? '
     'unit->address : unit->home_address) != 1 || setting.settings != NULL)'),
    ('the call that hears the refusal is the one that ends',
     'src/hps167s_settings.c | fathom_hps167s_restore_factory_settings | logical: status == FATHOM_ERR_UNCONFIRMED '
     '&& is_reset_refused(sensor) -> is_reset_refused(sensor) | return status == FATHOM_ERR_UNCONFIRMED && '
     'is_reset_refused(sensor) ? FATHOM_ERR_EXCEPTION : status'),
    ('it is READY, 1, or negative',
     'src/hps167s.c | fathom_hps167s_init | relational: < -> <= | if (config->address > FATHOM_HPS167S_MAX_ADDRESS '
     '|| config->same_answers > MAX_SAME_ANSWERS || fathom_hps167s_set_limits(& sensor->limits, & config->limits) < '
     '0)',
     'src/hps167s.c | fathom_hps167s_init | constant: 0 -> 1 | if (config->address > FATHOM_HPS167S_MAX_ADDRESS || '
     'config->same_answers > MAX_SAME_ANSWERS || fathom_hps167s_set_limits(& sensor->limits, & config->limits) < 0)',
     'src/hps167s_auto.c | fathom_hps167s_auto_init | relational: < -> <= | if (config->line == NULL || '
     'config->address > FATHOM_HPS167S_MAX_ADDRESS || fathom_hps167s_set_limits(& sensor->limits, & config->limits) '
     '< 0)',
     'src/hps167s_auto.c | fathom_hps167s_auto_init | constant: 0 -> 1 | if (config->line == NULL || config->address '
     '> FATHOM_HPS167S_MAX_ADDRESS || fathom_hps167s_set_limits(& sensor->limits, & config->limits) < 0)',
     'src/modbus_setting.c | looked | relational: < -> <= | if (status < 0 || (is_so && is_told(unit, setting)))',
     'src/modbus_setting.c | looked | constant: 0 -> 1 | if (status < 0 || (is_so && is_told(unit, setting)))',
     'src/modbus_setting.c | written | relational: < -> <= | const bool is_lost = unit->step == WRITE_UNSEEN && status '
     '< 0',
     'src/modbus_setting.c | written | constant: 0 -> 1 | const bool is_lost = unit->step == WRITE_UNSEEN && status < '
     '0',
     'src/modbus_setting.c | confirmed | relational: < -> <= | if (status < 0)',
     'src/modbus_setting.c | confirmed | constant: 0 -> 1 | if (status < 0)',
     'src/modbus_setting.c | confirmed | relational: < -> <= | return unit->outcome < 0 ? (fathom_status_t) '
     'unit->outcome : FATHOM_ERR_DIFFERS',
     'src/modbus_setting.c | confirmed | constant: 0 -> 1 | return unit->outcome < 0 ? (fathom_status_t) '
     'unit->outcome : FATHOM_ERR_DIFFERS',
     'src/a16_controlled.c | fathom_a16_controlled_init | relational: < -> <= | if (fathom_dyp_answer_init(answer, '
     'FATHOM_A16_MAX_MM) < 0 || sensor->line == NULL || sensor->earliest_us > sensor->latest_us)',
     'src/a16_controlled.c | fathom_a16_controlled_init | constant: 0 -> 1 | if (fathom_dyp_answer_init(answer, '
     'FATHOM_A16_MAX_MM) < 0 || sensor->line == NULL || sensor->earliest_us > sensor->latest_us)',
     'src/dyp_modbus.c | fathom_dyp_modbus_init | relational: < -> <= | return status < 0 ? status : '
     'fathom_modbus_unit_init(& sensor->unit, modbus, clock, address)',
     'src/dyp_modbus.c | fathom_dyp_modbus_init | constant: 0 -> 1 | return status < 0 ? status : '
     'fathom_modbus_unit_init(& sensor->unit, modbus, clock, address)',
     'src/dyp_auto.c | fathom_dyp_auto_init | constant: 0 -> 1 | if (sensor->line == NULL || status < 0)',
     'src/dyp_auto.c | fathom_dyp_auto_init | relational: < -> <= | if (sensor->line == NULL || status < 0)',
     'src/a16_auto.c | fathom_a16_auto_init | constant: 0 -> 1 | if (status < 0 || (sensor->select == NULL && '
     '!config->real_time))',
     'src/a16_auto.c | fathom_a16_auto_init | relational: < -> <= | if (status < 0 || (sensor->select == NULL && '
     '!config->real_time))'),
    ('no pair of switches either, or a distance of 0, which is refused anyway',
     'src/hps167s.c | fathom_hps167s_init | constant: NEVER_TOLD -> (NEVER_TOLD + 1) | sensor->told[0] = NEVER_TOLD',
     'src/hps167s.c | fathom_hps167s_init | constant: NEVER_TOLD -> (NEVER_TOLD - 1) | sensor->told[0] = NEVER_TOLD',
     'src/hps167s.c | fathom_hps167s_init | constant: NEVER_TOLD -> 0 | sensor->told[0] = NEVER_TOLD'),
    ('no pair of switches either',
     'src/hps167s.c | fathom_hps167s_init | constant: NEVER_TOLD -> (NEVER_TOLD + 1) | sensor->measured[0] = '
     'NEVER_TOLD',
     'src/hps167s.c | fathom_hps167s_init | constant: NEVER_TOLD -> (NEVER_TOLD - 1) | sensor->measured[0] = '
     'NEVER_TOLD'),
    ('symmetric',
     'src/hps167s.c | poll | arguments: values, sensor->told -> sensor->told, values | if (!same_4(values, '
     'sensor->told))',
     'src/hps167s_info.c | is_believed | arguments: values, sensor->measured -> sensor->measured, values | if '
     '(!fathom_hps167s_may_be_configuration(values) || same_4(values, sensor->measured))',
     'src/hps167s_info.c | is_believed | arguments: values, sensor->told -> sensor->told, values | if '
     '(!same_4(values, sensor->told))',
     'src/modbus_client.c | judge | arguments: message->head, bytes -> bytes, message->head | if (match->status == '
     'FATHOM_READY && message->head[1] != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS && begins_alike(message->head, '
     'bytes))'),
    ('at most 9 * 255',
     'src/hps167s_info.c | tenths_of_celsius | type: int32_t -> int16_t | const int32_t divisor = 9 * (int32_t) '
     'steps'),
    ('a dividend of 0 gives 0 either way',
     'src/hps167s_info.c | tenths_of_celsius | relational: >= -> > | return (dividend >= 0 ? dividend + divisor / 2 '
     ': dividend - divisor / 2) / divisor',
     'src/hps167s_info.c | tenths_of_celsius | constant: 0 -> 1 | return (dividend >= 0 ? dividend + divisor / 2 : '
     'dividend - divisor / 2) / divisor'),
    ('looks at the byte when the next one has come; what is taken is the same',
     'src/hps167s_auto.c | fits | name: FUNCTION -> SIZE | if (sensor->have > FUNCTION && bytes[FUNCTION] != '
     'FATHOM_MODBUS_READ_HOLDING_REGISTERS)',
     'src/hps167s_auto.c | fits | name: SIZE -> DATA | if (sensor->have > SIZE && bytes[SIZE] != DATA_SIZE)'),
    ('whoever learns of an echo drops its bytes next, which clears that bit',
     'src/line_inside.h |  | constant: 6 -> 7 | ECHO_KNOWN = 6'),
    ('with seven bytes the eighth is asked for, either way',
     'src/modbus_client.c |  | constant: 8 -> 7 | LEAST_REQUEST = 8'),
    ('the CRC of no bytes is not 0, and no frame has one byte',
     'src/modbus_client.c | look_for_request | condition: length == 0 -> 0 | if (length == 0)',
     'src/modbus_client.c | look_for_request | jump dropped: it -> nothing | if (length == 0) return',
     'src/modbus_client.c | look_for_request | constant: 0 -> 1 | if (length == 0)',
     'src/modbus_client.c | judge | logical: length != 0 && length <= have -> length <= have | if (length != 0 && '
     'length <= have && fathom_crc16(bytes, length) == 0)',
     'src/modbus_client.c | judge | constant: 0 -> 1 | if (length != 0 && length <= have && fathom_crc16(bytes, '
     'length) == 0)'),
    ('where there is no exchange the line only asks whether the checksum is wrong',
     'src/modbus_client.c | judge | name: FATHOM_PENDING -> FATHOM_READY | match->status = FATHOM_PENDING',
     'src/dyp_client.c | judge | name: FATHOM_PENDING -> FATHOM_READY | match->status = exchange != NULL ? '
     'answer(request, frame, match->unit) : (int8_t) FATHOM_PENDING'),
    ('a number that no other step has; they are compared for equality alone',
     'src/modbus_setting.c |  | constant: 5 -> 6 | WRITE_UNSEEN = 5'),
    ("no write's name: they have the highest bit",
     'src/modbus_setting.c | written | constant: 0 -> 1 | unit->given = is_lost ? 0 : unit->setting',
     'src/hps167s_settings.c | set_all | constant: 0 -> 1 | unit->given = 0'),
    ('the value that was given is looked at only where `given` is the setting, and it is none after a broadcast',
     'src/hps167s_settings.c | set_all | statement dropped: it -> nothing | setting.value = value'),
    ('FF or 0',
     'src/hps167s_settings.c | set_all | type: uint16_t -> uint8_t | const uint16_t value = is_on ? ON : OFF'),
    ('a sensor whose init has failed is not used',
     'src/hps167s.c | fathom_hps167s_init | condition: status == FATHOM_READY -> 1 | if (status == FATHOM_READY)'),
    ('2 s ago or longer: no frame that was not asked for is near',
     'src/hps167s.c | fathom_hps167s_init | constant: FATHOM_HPS167S_UNASKED_US -> (FATHOM_HPS167S_UNASKED_US + 1) | '
     'sensor->unasked_us = (uint32_t) (sensor->unit.polled_us - FATHOM_HPS167S_UNASKED_US)'),
    ('an int of 32 bits holds what is shifted; the tests on an int of 16 bits see it',
     'src/hps167s_info.c | reconnect_time_ms | type: uint32_t -> uint16_t | return sensor->low_word_first ? (uint32_t) '
     'last << 16 | first : (uint32_t) first << 16 | last',
     'src/hps167s_info.c | reconnect_time_ms | type: uint32_t -> uint16_t | return sensor->low_word_first ? (uint32_t) '
     'last << 16 | first : (uint32_t) first << 16 | last | 2'),
    ('set by the read, and not looked at after a write',
     'src/modbus_setting.c | fathom_modbus_set | constant: 0 -> 1 | uint32_t value = 0'),
    ('the register is not sent; the function alone is looked at',
     'src/dyp_client.c |  | constant: 0x0200 -> 0x0000 | ADDRESS_REGISTER = 0x0200',
     'src/dyp_client.c |  | constant: 0x0200 -> 0x01FF | ADDRESS_REGISTER = 0x0200',
     'src/dyp_client.c |  | constant: 0x0200 -> 0x0201 | ADDRESS_REGISTER = 0x0200',
     'src/dyp_client.c | fathom_dyp_client_set_every_address | arguments: ADDRESS_REGISTER, address -> address, '
     'ADDRESS_REGISTER | fathom_modbus_write_single_register(& request->message, address, ADDRESS_REGISTER, address)'),
    ('AA alone is a second probe at 43520 mm or more too, which no A05 measures',
     'src/dyp_client.c | is_two_frames | logical: frame[NEXT] == frame[0] && frame[NEXT + 1] == frame[1] -> '
     'frame[NEXT + 1] == frame[1] | return frame[NEXT] == frame[0] && frame[NEXT + 1] == frame[1]'),
    ('with fewer than three bytes the line does not look at the unit',
     'src/dyp_client.c | judge | relational: < -> <= | match->unit = frame[ADDRESS < have ? ADDRESS : 0]',
     'src/dyp_client.c | judge | condition: ADDRESS < have -> 1 | match->unit = frame[ADDRESS < have ? ADDRESS : 0]',
     'src/dyp_client.c | judge | constant: 0 -> 1 | match->unit = frame[ADDRESS < have ? ADDRESS : 0]'),
    ('the line looks at `request` only if the unit is the one that was asked',
     'src/dyp_client.c | judge | logical: have >= FATHOM_DYP_REQUEST_LENGTH && frame[ADDRESS] == head[0] -> have >= '
     'FATHOM_DYP_REQUEST_LENGTH | if (have >= FATHOM_DYP_REQUEST_LENGTH && frame[ADDRESS] == head[0] && '
     'frame[COMMAND] == command_of(head) && fathom_dyp_protocol_valid(frame, FATHOM_DYP_REQUEST_LENGTH))'),
    ('only looked at while the trigger is low, whose falling edge sets it',
     'src/pulse.c | fathom_pulse_init | statement dropped: it -> nothing | meter->low_left_us = 0',
     'src/pulse.c | fathom_pulse_init | constant: 0 -> 1 | meter->low_left_us = 0'),
    ('nothing but init may follow',
     'src/pulse.c | fathom_pulse_deinit | statement dropped: it -> nothing | meter->waiting = false',
     'src/pulse.c | fathom_pulse_deinit | constant: false -> true | meter->waiting = false'),
    ('writes a value behind the last, which nobody reads; the bounds check of the sanitizer builds ends there',
     'src/a16_controlled.c | judge | constant: 1 -> 2 | fathom_dyp_frame_decode(frame, answer->values, 1)'),
    ('only looked at after bytes have come, which set it',
     'src/a16_controlled.c | fathom_a16_controlled_init | statement dropped: it -> nothing | sensor->came_us = '
     'sensor->edge_us'),
    ('only looked at after a falling edge, which sets it',
     'src/a16_controlled.c | fathom_a16_controlled_init | statement dropped: it -> nothing | sensor->low_left_us = 0',
     'src/a16_controlled.c | fathom_a16_controlled_init | constant: 0 -> 1 | sensor->low_left_us = 0',
     'src/a16_controlled.c | fathom_a16_controlled_init | constant: 0 -> 1 | sensor->answer_left_us = 0',
     'src/a16_controlled.c | fathom_a16_controlled_init | statement dropped: it -> nothing | sensor->heard = false',
     'src/a16_controlled.c | fathom_a16_controlled_init | constant: false -> true | sensor->heard = false'),
    ('the end of these 71 minutes is not told; it is due 1 us earlier',
     'src/a16_controlled.c | fathom_a16_controlled_init | constant: UINT32_MAX -> (UINT32_MAX - 1) | '
     'sensor->stream_config.stale_us = UINT32_MAX'),
    ('the one fitted probe, which is told either way',
     'src/dyp_auto.c | odd_probe | relational: <= -> < | for (uint8_t bit = 1; bit <= sensor->probes; bit = (uint8_t) '
     '(bit << 1), value ++)'),
    ('looked at only where the unit is the one that was asked, and unit 0 was not',
     'src/modbus_client.c | judge | constant: 0 -> 1 | const uint8_t length = is_none ? 0 : '
     'fathom_modbus_rtu_response_length(bytes, have)'),
    ('looked at only after the first word, which sets it',
     'src/contact.c | fathom_contact_init | statement dropped: it -> nothing | contact->period_us = own->period_us'),
    ('neither NEAR nor FAR',
     'src/contact.c | fathom_contact_init | constant: 0 -> 1 | contact->said = 0'),
    ('set before it is looked at',
     'src/dyp_modbus.c | fathom_dyp_modbus_address | constant: 0 -> 1 | uint16_t value = 0',
     'src/dyp_modbus.c | read | constant: 0 -> 1 | uint16_t found = 0',
     'src/a16_settings.c | get_choice | constant: 0 -> 1 | uint16_t found = 0'),
    ('the second value of a setting that has one',
     'src/dyp_modbus.c | fathom_dyp_modbus_write | constant: 0 -> 1 | return set(sensor, address, value, 0, false)'),
    ('set by an answer, before which there is no sample',
     'src/dyp.c | fathom_dyp_answer_init | constant: 0 -> 1 | answer->time_us = 0',
     'src/dyp.c | fathom_dyp_answer_init | statement dropped: it -> nothing | answer->time_us = 0'),
    ('the distance is not looked at',
     'src/a05_dyp.c | read_address | type: uint16_t -> uint8_t | uint16_t distance = 0',
     'src/a05_dyp.c | read_address | constant: 0 -> 1 | uint16_t distance = 0'),
    ('an address has 8 bits',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | type: uint16_t -> uint8_t | uint16_t value = address'),
    ('init has already set what a new sequence sets',
     'src/a05_relay_rule.c | fathom_a05_relay_rule_init | statement dropped: it -> nothing | rule->sequence = 0',
     'src/a05_relay_rule.c | fathom_a05_relay_rule_init | constant: 0 -> 1 | rule->sequence = 0'),
    ('nothing is left of a hold then',
     'src/debounce.c | fathom_debounce_init | statement dropped: it -> nothing | debounce->fed_us = 0',
     'src/debounce.c | fathom_debounce_init | constant: 0 -> 1 | debounce->fed_us = 0'),
    ('the first verdict differs from NEITHER and sets the row to 0',
     'src/debounce.c | fathom_debounce_init | statement dropped: it -> nothing | debounce->verdict = NEITHER',
     'src/debounce.c | fathom_debounce_init | statement dropped: it -> nothing | debounce->row = 0',
     'src/debounce.c | fathom_debounce_init | constant: 0 -> 1 | debounce->row = 0'),
    ('a pulse that is not new is not returned',
     'src/edges.c | take | condition: is_new -> 1 | if (is_new)'),
    ('looked at only after a rising edge, which sets it',
     'src/edges.c | fathom_edges_init | statement dropped: it -> nothing | edges->rise_us = 0',
     'src/edges.c | fathom_edges_init | constant: 0 -> 1 | edges->rise_us = 0'),
    ('looked at only while it listens, and is set when that begins',
     'src/a16_rs232.c | fathom_a16_rs232_init | statement dropped: it -> nothing | rs232->since_us = 0',
     'src/a16_rs232.c | fathom_a16_rs232_init | constant: 0 -> 1 | rs232->since_us = 0'),
    ('half the range of the clock is 35 minutes, and nobody waits so long',
     'src/a16_rs232.c | is_since | relational: <= -> < | return fathom_elapsed_us(time_us, rs232->since_us) <= '
     'INT32_MAX',
     'src/a16_rs232.c | is_since | constant: INT32_MAX -> (INT32_MAX + 1) | return fathom_elapsed_us(time_us, '
     'rs232->since_us) <= INT32_MAX',
     'src/a16_rs232.c | is_since | constant: INT32_MAX -> (INT32_MAX - 1) | return fathom_elapsed_us(time_us, '
     'rs232->since_us) <= INT32_MAX'),
    ('the callers give a variable of their own, and copy it where the status, which is told either way, is READY',
     'src/a16_settings.c | get_choice | condition: status != FATHOM_READY -> 0 | if (status != FATHOM_READY)',
     'src/a16_settings.c | get_choice | jump dropped: it -> nothing | if (status != FATHOM_READY) return status'),
    ('of the write only the address is sent, and no other question has its name',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | statement dropped: it -> nothing | write.first = '
     'FATHOM_DYP_REGISTER_ADDRESS',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | statement dropped: it -> nothing | write.count = 1',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | constant: 1 -> 0 | write.count = 1',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | constant: 1 -> 2 | write.count = 1'),
    ('a setting keeps all others out, and after its first look there is no back-off that a command would not wait for',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | constant: true -> false | write.is_command = true',
     'src/a05_dyp.c | fathom_a05_dyp_set_every_address | statement dropped: it -> nothing | write.is_command = true'),
    ('more than 65535 mm either way, which is what is said',
     'src/pulse_width.c | bounded_us | constant: LONGEST_US -> (LONGEST_US - 1) | return width_us < LONGEST_US ? '
     'width_us : LONGEST_US',
     'src/pulse_width.c | bounded_us | constant: LONGEST_US -> (LONGEST_US + 1) | return width_us < LONGEST_US ? '
     'width_us : LONGEST_US | 2',
     'src/pulse_width.c | bounded_us | constant: LONGEST_US -> (LONGEST_US - 1) | return width_us < LONGEST_US ? '
     'width_us : LONGEST_US | 2'),
    ('what is not in mm is in the rest',
     'src/pulse_width.c | fathom_pulse_width_mm_in_air | constant: 20000 -> 20001 | const uint32_t mm = high / 20000'),
    ('the speed is even, so that no product ends in 9999999',
     'src/pulse_width.c | fathom_pulse_width_mm_in_air | constant: 10000000 -> 10000001 | return bounded_mm(mm + '
     '(rest + 10000000) / 20000000)'),
    ("the frame's check looks at its first byte as well; here it spares a copy",
     'src/stream.c | take | logical: stream->run < length || ring[stream->oldest] != FATHOM_DYP_START -> stream->run '
     '< length | if (stream->run < length || ring[stream->oldest] != FATHOM_DYP_START)'),
    ('compared with the length of a frame alone, and stops counting a byte later',
     'src/stream.c | fathom_stream_feed | constant: UINT8_MAX -> (UINT8_MAX - 1) | stream->since = UINT8_MAX',
     'src/stream.c | fathom_stream_init | constant: UINT8_MAX -> (UINT8_MAX - 1) | stream->since = UINT8_MAX'),
    ("it turns the bit of all questions alike; their names stay different, and none is 0 since no question's register is",
     'src/modbus_unit.c | fathom_modbus_unit_name | condition: question->is_command -> !(question->is_command) | if '
     '(question->is_command)'),
    ('looked at only after a frame has come, which sets it',
     'src/stream.c | fathom_stream_init | statement dropped: it -> nothing | stream->time_us = now_us'),
    ('looked at only while there is a candidate, which sets it',
     'src/stream.c | fathom_stream_init | statement dropped: it -> nothing | stream->candidate_us = now_us'),
    ('a ring may begin anywhere',
     'src/stream.c | fathom_stream_init | constant: 0 -> 1 | stream->oldest = 0'),
    ('a silence that a listener wants to know of has 16 bits',
     'src/stream.c | fathom_stream_due_us | type: uint32_t -> uint16_t | const uint32_t silence_us = '
     'silence_left_us(stream, now_us)'),
    ('a setting without a read begins at WRITE_UNSEEN; it is asked where clang\'s analyzer sees that no null is called',
     'src/modbus_setting.c | fathom_modbus_set | logical: setting->read == NULL || unit->step == WRITE -> unit->step '
     '== WRITE | const bool is_write = setting->read == NULL || unit->step == WRITE || unit->step == WRITE_UNSEEN'),
]

assert sum(len(row) - 1 for row in ROWS) == COUNT
