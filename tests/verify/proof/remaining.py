# SPDX-License-Identifier: MIT
"""What is not proved: alarms that EVA does not discharge, each with its argument, statements that no run reaches, and
sources that no harness covers. These lists may only get shorter.

EVA knows the values of each member, not how members go together. Each argument is such a relation: it says which lines
make it, so that it can be checked by reading them."""

BYTES = """passed_count <= received_count <= frame_size, and received_count >= 1 where a protocol or the part for
masters reads the buffer: fathom_line_scan calls take_front only then. read_port gives read the room that is left,
frame_size - received_count, and receive adds what read returns, which is no more, or nothing of it. What leaves the
buffer is received_count at most: take_front returns received_count, or 1, or a length that it has compared with
received_count, of a frame, of a request of another master, or of our own request. discard passes on from passed_count
up to that length, and remove_bytes takes it from both counts. form_of reads no byte before it has compared
received_count with its index. is_ours passes request_length to is_request: it is not 0 there, and encode, which has
written that number of bytes to the buffer, returned it. fathom_line_marks moves the new bytes to the front after a scan
with is_over, which leaves nothing there: NEED_MORE is returned only if is_over is false. NEED_MORE is returned only for
a frame, an echo or a request of at most frame_size bytes of which some are missing, so that a full buffer is never
left: the room is never 0. (Of a line that only listens EVA sees all this: there received_count is 0 whenever the port
is read.)"""

QUEUE = """link.next is a pointer in each transaction of the queue: fathom_line_submit sets it to NULL as it appends the
transaction, and only fathom_line_finish writes heard_us in its place, after the transaction was unlinked. All walks
begin at head and follow these; the caller leaves a transaction alone while it is queued (line.h), and has set protocol,
address, time-out and settings before."""

WIRE = """head is not NULL where request_length is not 0, or the phase is PORT_BUSY or more: send_next sets them after
move_to_front has put a transaction in front, and nothing is put in front of one on the wire, since advance calls
send_next in no phase above PORT_BUSY but WAITING, after the attempt has ended. As the first one is unlinked,
fathom_line_finish makes a phase of PORT_BUSY or more IDLE, and request_length 0; in phases below, fathom_line_cancel or
fathom_line_end_attempt has called fathom_line_free_wire right before. fathom_line_break changes only phases below
SENDING, where request_length is 0. is_old reads head where it has seen that it is not NULL."""

PROTOCOL = """line->protocol is not NULL where request_length is not 0: fathom_line_submit sets it before a request can
leave, begin_attempt sets it with request_length, and nothing resets it. is_ours and fathom_line_is_echo read it only if
expects_response() is true, that is, if request_length is not 0. take_front sets its length to 0 if line->protocol is NULL.
Without a length nothing is complete and nothing is a frame: take_front calls check only if is_complete is true,
accept_frame only if is_frame is true, and is_damaged_response reads the protocol only if frame_length, which is this
length, is not 0."""

RATE = """unit.line_settings of the HPS-167S's driver is NULL for ever or never. Where config has none: set_baud refuses
before it begins, so that no command is BAUD, and move_to_baud and expect_baud do nothing, so that with_baud is not
called. Where config has some: fathom_modbus_set keeps them in known_line_settings before restore_address or cancel
bring those back, and change_over puts other in their place, which seek has set to what with_baud returned."""

FLAG = """EVA reads a volatile member as any byte. is_high, is_full and was_armed hold what edges.c and the clear() of
fathom_edges_init() store there, which is true, false or 0, and nothing else writes to them (edges.h)."""

# {(file, function, 'kind: property' as eva.py prints it): why it cannot be, which a reader can check}
ARGUED = {
    ('src/codec/dyp_55aa.c', 'fathom_dyp_55aa_is_valid', 'mem_access: \\valid_read(frame_0 + last)'): BYTES,
    ('src/codec/dyp_stream.c', 'fathom_dyp_checksum', 'mem_access: \\valid_read(bytes)'): BYTES,
    ('src/engine/edges.c', 'arm',
     'bool_value: edges->pulses[edges->read_at].is_full == 0 || edges->pulses[edges->read_at].is_full == 1'): FLAG,
    ('src/engine/edges.c', 'fall', 'bool_value: place->is_full == 0 || place->is_full == 1'): FLAG,
    ('src/engine/edges.c', 'fathom_edges_feed', 'bool_value: edges->was_armed == 0 || edges->was_armed == 1'): FLAG,
    ('src/engine/edges.c', 'rise', 'bool_value: edges->is_high == 0 || edges->is_high == 1'): FLAG,
    ('src/engine/edges.c', 'take', 'bool_value: edges->is_high == 0 || edges->is_high == 1'): FLAG,
    ('src/engine/edges.c', 'take', 'bool_value: place->is_full == 0 || place->is_full == 1'): FLAG,
    ('src/engine/fair_share.c', 'next_0', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/fair_share.c', 'next_1', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line.c', 'fathom_line_is_old', 'mem_access: \\valid_read(&(line_0->head)->timeout_us)'): WIRE,
    ('src/engine/line.c', 'fathom_line_pass', 'pointer_value: \\object_pointer((line_0->parts)->frame + from)'): BYTES,
    ('src/engine/line.c', 'read_port',
     'pointer_value: \\object_pointer((line_0->parts)->frame + line_0->received_count)'): BYTES,
    ('src/engine/line_attempt.c', 'fathom_line_end_attempt',
     'mem_access: \\valid_read(&(line_0->head)->attempts)'): WIRE,
    ('src/engine/line_attempt.c', 'fathom_line_end_attempt',
     'mem_access: \\valid_read(&(line_0->head)->retries)'): WIRE,
    ('src/engine/line_attempt.c', 'fathom_line_find', 'pointer_value: \\object_pointer(&(*link)->link.next)'): QUEUE,
    ('src/engine/line_attempt.c', 'fathom_line_find', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_attempt.c', 'fathom_line_finish', 'mem_access: \\valid_read(&transaction->link.next)'): QUEUE,
    ('src/engine/line_attempt.c', 'fathom_line_finish', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_attempt.c', 'fathom_line_finish',
     'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_attempt.c', 'fathom_line_quarantine', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_attempt.c', 'fathom_line_quarantine', 'mem_access: \\valid_read(&transaction->timeout_us)'): WIRE,
    ('src/engine/line_internal.h', 'is_from_unit_of_1', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_internal.h', 'is_from_unit_of_2', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_internal.h', 'is_from_unit_of_4', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_internal.h', 'is_from_unit_of_5', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_internal.h', 'may_collide_4', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_internal.h', 'may_collide_5', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_internal.h', 'may_collide_6', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_internal.h', 'may_collide_7', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_internal.h', 'may_collide_10', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_internal.h', 'may_collide_9', 'mem_access: \\valid_read(&protocol->may_collide)'): QUEUE,
    ('src/engine/line_masters.c', 'is_ours', 'mem_access: \\valid_read(&(line_0->protocol)->is_request)'): PROTOCOL,
    ('src/engine/line_options.c', 'fathom_line_marks', 'mem_access: \\valid(frame_0 + i)'): BYTES,
    ('src/engine/line_options.c', 'fathom_line_marks', 'mem_access: \\valid_read(new_bytes + i)'): BYTES,
    ('src/engine/line_request.c', 'begin_attempt', 'mem_access: \\valid_read(&protocol->is_unit_0_ordinary)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_cancel', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_cancel_unit',
     'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_is_queued', 'pointer_value: \\object_pointer(queued->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_submit', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'follow_request', 'mem_access: \\valid_read(&(line_0->head)->timeout_us)'): WIRE,
    ('src/engine/line_request.c', 'move_to_front', 'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'next', 'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'next_0', 'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'send_next', 'mem_access: \\valid_read(&(transaction->protocol)->encode)'): QUEUE,
    ('src/engine/line_response.c', 'accept_frame',
     'mem_access: \\valid_read(&(line_0->protocol)->address_offset)'): PROTOCOL,
    ('src/engine/line_response.c', 'accept_response', 'mem_access: \\valid_read(&(line_0->head)->address)'): WIRE,
    ('src/engine/line_response.c', 'take_front', 'mem_access: \\valid_read(&protocol->check)'): PROTOCOL,
    ('src/engine/line_response.c', 'is_damaged_response',
     'mem_access: \\valid_read(&(line_0->protocol)->address_offset)'): PROTOCOL,
    ('src/engine/line_echo.c', 'fathom_line_is_echo', 'mem_access: \\valid_read(&protocol->is_request)'): PROTOCOL,
    ('src/engine/line_response.c', 'remove_bytes', 'mem_access: \\valid(frame_0 + i)'): BYTES,
    ('src/engine/line_response.c', 'remove_bytes',
     'mem_access: \\valid_read(frame_0 + (int)((int)i + (int)length_0))'): BYTES,
    ('src/engine/line_response.c', 'serve',
     'mem_access: \\valid_read(&(transaction->protocol)->parse_response)'): QUEUE,
    ('src/engine/line_response.c', 'serve', 'mem_access: \\valid_read(&transaction->attempts)'): QUEUE,
    ('src/engine/line_response.c', 'serve', 'pointer_value: \\object_pointer(&(*link)->link.next)'): QUEUE,
    ('src/engine/line_response.c', 'serve', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_turns.c', 'notify', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/sensor/hps167s_settings.c', 'baud_code',
     'mem_access: \\valid_read(&(sensor_0->unit.line_settings)->baud)'): RATE,
    ('src/sensor/hps167s_settings.c', 'with_baud', 'mem_access: \\valid_read(&old->parity)'): RATE,
    ('tests/verify/proof/assumptions.h', 'any_bytes', 'mem_access: \\valid(bytes + i)'): BYTES,
    ('tests/verify/proof/assumptions.h', 'assumed_read', 'user assertion: 1 <= capacity <= 255'): BYTES,
    ('tests/verify/proof/assumptions.h', 'assumed_read', 'user assertion: \\valid(bytes + (0 .. capacity - 1))'): BYTES,
    ('tests/verify/proof/assumptions.h', 'assumed_set_line',
     'user assertion: \\initialized(&settings_0->baud) && \\initialized(&settings_0->parity) && '
     '\\initialized(&settings_0->stop_bits)'): QUEUE,
    ('tests/verify/proof/contracts.h', 'fathom_crc16',
     'user assertion: length_0 == 0 || \\initialized(bytes + (0 .. length_0 - 1))'): BYTES,
    ('tests/verify/proof/contracts.h', 'fathom_crc16',
     'user assertion: length_0 == 0 || \\valid_read(bytes + (0 .. length_0 - 1))'): BYTES,
    ('tests/verify/proof/line/line.c', 'check', 'user assertion: 1 <= length_of_it <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'is_request', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('tests/verify/proof/line/line.c', 'is_request', 'user assertion: 1 <= have <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'length', 'user assertion: 1 <= have <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'receive',
     'user assertion: bytes == (uint8_t *)frame && of_them <= FRAME_SIZE'): BYTES,
}

# Sources of which nothing is shown: their harnesses say `to prove:`, and are not run.
UNPROVED = ()

NO_HIGH_BYTE = 'the number of registers in a read has 8 bits, so its high byte in the request, head[4], is 0'
REFUSED_BEFORE = 'fathom_hps167s_init has refused `address_zero` and every address above 32 before'
ONE_PROBE = 'an A16 has one probe, so no value is left when it is polled; line/a05_modbus reaches this'
NO_RATE = 'a setting of an A16 changes no line settings; line/hps167s_settings reaches this'
NO_FOLLOW = 'nothing is set, so `follow` is NULL; line/hps167s_settings reaches this'

HAS_ROOM = 'the drivers ask fathom_modbus_unit_has_room() before, which refuses a line that is not initialised'
ONE_REGISTER = 'a line has a buffer of 8 bytes or more, and the response of an A16 has 7; line/a05_modbus reaches this'

# Statements that no run of a harness reaches: {(harness, function): (their number, why)}.
UNREACHED = {
    ('line/a16_modbus', 'fathom_dyp_modbus_sensor_due_us'): (1, ONE_PROBE),
    ('line/a16_modbus', 'fathom_modbus_unit_has_room'): (1, ONE_REGISTER),
    ('line/a16_modbus', 'moves'): (1, NO_RATE),
    ('line/a16_modbus', 'use_new_address'): (1, NO_RATE),
    ('line/clients', 'command_of_read'): (3, NO_HIGH_BYTE),
    ('line/hps167s', 'fathom_hps167s_follow'): (1, NO_FOLLOW),
    ('line/hps167s', 'fathom_hps167s_power_on'): (1, NO_FOLLOW),
    ('line/hps167s', 'is_valid_0'): (3, REFUSED_BEFORE + '; ' + HAS_ROOM),
    ('line/hps167s_auto', 'fathom_hps167s_auto_sensor_due_us'):
        (1, 'the harness polls before each due_us, and the poll takes the reading'),
    ('line/line', 'fathom_line_submit'): (3, 'the line of the harness can send, so `fail_all` is not NULL'),
}
