# SPDX-License-Identifier: MIT
"""What is not proved: alarms that EVA does not discharge, each with its argument, statements that no run reaches, and
sources that no harness covers. These lists may only get shorter.

EVA knows the values of each member, not how members go together. Each argument is such a relation: it says which lines
make it, so that it can be checked by reading them."""

BYTES = """have <= frame_size, and 1 <= have where a protocol is asked. fathom_line_poll gives read the room that is
left, frame_size - have, and adds what it returns, which is no more. What leaves is no more than have: judge returns
have, or 1 where scan_responses has seen that have is not 0, or a length or an echo of which it has seen that its
value less one, as 8 bits, is under have. marks returns what came, or 0; before it moves what came to the front, scan
has left nothing there, since where it is over judge returns nothing below 0. need is a length up to frame_size or
that of a request, so that with have = frame_size scan is called, and leaves less than frame_size: the room is never 0.
(Of a line that only listens EVA sees it all: there have is 0 whenever the port is read.)"""

QUEUE = """link.next is a pointer in each transaction of the queue: submit sets it to NULL as it appends the
transaction, and nothing but fathom_line_finish writes heard_us in its place, after the transaction was unlinked. All
walks begin at head and follow these; the caller leaves a transaction alone while it is queued (line.h), and has set
protocol, address, time-out and settings before."""

WIRE = """head is not NULL where sent is not 0, or the phase is REFUSED or more: fathom_line_send sets them as it has
put a transaction in front, and nothing is put in front of one on the wire, since go_on sends only in IDLE and REFUSED.
As the first one leaves, fathom_line_finish makes a state of REFUSED or more IDLE, and sent 0; where it does not,
fathom_line_end_attempt has done so right before it, or fathom_line_cancel has made the state LEAVING, and sent 0.
fathom_line_break changes only a state under SENDING, where sent is 0. A state under REFUSED is the phase alone: each is
assigned as a whole, and the bits above it are set only where sent is not 0, or a transaction is on the wire."""

PROTOCOL = """line->protocol is not NULL where sent or quarantined is not 0: fathom_line_send sets it beside sent,
nothing resets it, and quarantine sets bits only where sent is not 0."""

RATE = """unit.line_settings of the HPS-167S's driver is NULL for ever or never. Where config has none: set_baud refuses
before it begins, so that no command is BAUD, and move_to_baud and expect_baud do nothing, so that with_baud is not
called. Where config has some: fathom_modbus_set keeps them in known_line_settings before restore_address or cancel
bring those back, and change_over puts other in their place, which seek has set to what with_baud returned."""

# {(file, function, 'kind: property' as eva.py prints it): why it cannot be, which a reader can check}
ARGUED = {
    ('src/engine/fair_share.c', 'next_0', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line.c', 'fathom_line_drop', 'mem_access: \\valid(to)'): BYTES,
    ('src/engine/line.c', 'fathom_line_drop', 'mem_access: \\valid_read(to + length_0)'): BYTES,
    ('src/engine/line.c', 'fathom_line_poll', 'pointer_value: \\object_pointer(config_0->frame + had)'): BYTES,
    ('src/engine/line_marks.c', 'fathom_line_marks', 'mem_access: \\valid(to + i)'): BYTES,
    ('src/engine/line_marks.c', 'fathom_line_marks', 'mem_access: \\valid_read(from + i)'): BYTES,
    ('src/engine/line_marks.c', 'fathom_line_marks', 'pointer_value: \\object_pointer(to + line_0->have)'): BYTES,
    ('src/engine/line_request.c', 'fathom_line_cancel', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_cancel_unit', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_deliver', 'mem_access: \\valid_read(&(line_0->head)->address)'): WIRE,
    ('src/engine/line_request.c', 'fathom_line_deliver',
     'mem_access: \\valid_read(&(x->protocol)->parse_response)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_deliver', 'mem_access: \\valid_read(&protocol->address_at)'): PROTOCOL,
    ('src/engine/line_request.c', 'fathom_line_deliver', 'mem_access: \\valid_read(&x->attempts)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_deliver', 'pointer_value: \\object_pointer(&(*link)->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_deliver', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_end_attempt',
     'mem_access: \\valid_read(&(line_0->head)->attempts)'): WIRE,
    ('src/engine/line_request.c', 'fathom_line_end_attempt',
     'mem_access: \\valid_read(&(line_0->head)->retries)'): WIRE,
    ('src/engine/line_request.c', 'fathom_line_find', 'pointer_value: \\object_pointer(&(*link)->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_find', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_finish', 'mem_access: \\valid_read(&transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_finish', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_finish',
     'pointer_value: \\object_pointer(transaction->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_has', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'fathom_line_submit', 'pointer_value: \\object_pointer(*link)'): QUEUE,
    ('src/engine/line_request.c', 'go_on', 'mem_access: \\valid_read(&(line_0->head)->timeout_us)'): WIRE,
    ('src/engine/line_request.c', 'go_on_0', 'mem_access: \\valid_read(&(line_0->head)->timeout_us)'): WIRE,
    ('src/engine/line_request.c', 'is_of', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_request.c', 'next', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'next_1', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
    ('src/engine/line_request.c', 'quarantine', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('src/engine/line_request.c', 'quarantine', 'mem_access: \\valid_read(&transaction->timeout_us)'): WIRE,
    ('src/engine/line_response.c', 'judge', 'mem_access: \\valid_read(&protocol->length)'): PROTOCOL,
    ('src/engine/line_response.c', 'match_echo', 'mem_access: \\valid_read(&protocol->is_request)'): PROTOCOL,
    ('src/engine/line_send.c', 'fathom_line_send', 'mem_access: \\valid_read(&(x->protocol)->encode)'): QUEUE,
    ('src/engine/line_send.c', 'fathom_line_send', 'mem_access: \\valid_read(&(x->protocol)->zero_answers)'): QUEUE,
    ('src/engine/line_send.c', 'fathom_line_send', 'pointer_value: \\object_pointer(x->link.next)'): QUEUE,
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
    ('tests/verify/proof/line/line.c', 'check', 'user assertion: 1 <= length_of_it <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'is_request', 'mem_access: \\valid_read(&transaction->address)'): WIRE,
    ('tests/verify/proof/line/line.c', 'is_request', 'user assertion: 1 <= have <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'length', 'user assertion: 1 <= have <= FRAME_SIZE'): BYTES,
    ('tests/verify/proof/line/line.c', 'receive',
     'user assertion: bytes == (uint8_t *)frame && of_them <= FRAME_SIZE'): BYTES,
}

# Sources of which nothing is shown: their harnesses say `to prove:`, and are not run.
UNPROVED = ()

COPY = 'Frama-C copies the return behind an `||`, and nothing leads to the copy; split in two, each return is reached'
ONE_PROBE = 'an A16 has one probe, so no value is left when it is polled; line/a05_modbus reaches this'
A16 = 'the sensor is an A16; line/a05_modbus reaches this'
NO_RATE = 'a setting of an A16 changes no line settings; line/hps167s_settings reaches this'
NO_FOLLOW = 'nothing is set, so `follow` is NULL; line/hps167s_settings reaches this'

# Statements that no run of a harness reaches: {(harness, function): (their number, why)}.
UNREACHED = {
    ('line/a05_dyp', 'fathom_a05_dyp_set_every_address'): (3, COPY),
    ('line/a16_modbus', 'due_us'): (1, ONE_PROBE),
    ('line/a16_modbus', 'fathom_dyp_modbus_init'): (1, A16),
    ('line/a16_modbus', 'fathom_modbus_unit_init'): (3, COPY + '; and a transport of the harness has a clock'),
    ('line/a16_modbus', 'moves'): (1, NO_RATE),
    ('line/a16_modbus', 'poll'): (3, ONE_PROBE),
    ('line/a16_modbus', 'use_new_address'): (1, NO_RATE),
    ('line/clients', 'command_of_read'): (3, COPY + '; and the harness reads at most four registers'),
    ('line/hps167s', 'fathom_hps167s_ask'): (1, NO_FOLLOW),
    ('line/hps167s', 'fathom_hps167s_power_on'): (1, NO_FOLLOW),
    ('line/hps167s_auto', 'due_us'): (1, 'the harness polls before each due_us, and the poll takes the reading'),
    ('line/line', 'fathom_line_submit'): (3, 'the line of the harness can send, so `give_up` is not NULL'),
    ('pure/level', 'fathom_level_check'): (3, COPY),
}
