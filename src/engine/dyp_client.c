/* SPDX-License-Identifier: MIT */
/*
 * The protocol `55 AA` of a line, and the transport that turns Modbus reads into its commands. The write of register
 * 0x0200 stands for the command that sets the address.
 */
#include "fathom/engine/dyp_client.h"

#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"

/* Offsets in a frame. Behind the echo of a request, the response begins at NEXT. */
enum { ADDRESS = 2, COMMAND = 3, NEXT = FATHOM_DYP_REQUEST_LENGTH };

enum { ADDRESS_REGISTER = 0x0200 };

/* Returns the command for a Modbus read with this head, or 0 if there is none. */
static uint8_t command_of_read(const uint8_t *head)
{
    const uint8_t count = head[5];
    const uint16_t probe = (uint16_t)((head[2] * 256u) + head[3] - FATHOM_DYP_FIRST_REGISTER);
    if ((head[4] != 0u) || (probe >= FATHOM_DYP_PROBES)) return 0;
    if (count == 1u) return (uint8_t)(FATHOM_DYP_FIRST_PROBE + probe);
    return ((count == FATHOM_DYP_PROBES) && (probe == 0u)) ? FATHOM_DYP_ALL_PROBES : 0;
}

static uint8_t command_of(const uint8_t *head)
{
    return (head[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS) ? command_of_read(head) : FATHOM_DYP_SET_ADDRESS;
}

static const fathom_modbus_message_t *message_of(const fathom_transaction_t *transaction)
{
    return &((const fathom_modbus_request_t *)transaction)->message;
}

static uint8_t encode(const fathom_transaction_t *transaction, uint8_t *frame)
{
    const uint8_t *const head = message_of(transaction)->head;
    return fathom_dyp_55aa_encode_request(frame, head[0], command_of(head));
}

/*
 * Returns 0 if the sum is right, and 1 for an echo that looks like the beginning of a response.
 *
 * If the high byte of the first distance equals the sum of the request, the response begins with the five bytes of its
 * request. If 55 AA follows these bytes, they are the echo, and the response follows. In a response, AA would
 * be the high byte of the second distance, 43520 mm or more, which no A05 measures.
 */
static uint16_t check(const uint8_t *frame, uint8_t length)
{
    if ((length == FATHOM_DYP_MAX_RESPONSE) && (frame[NEXT] == frame[0]) && (frame[NEXT + 1] == frame[1]) &&
        fathom_dyp_55aa_is_valid(frame, NEXT))
        return 1;
    return !fathom_dyp_55aa_is_valid(frame, length);
}

static bool is_request(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have)
{
    const uint8_t *const head = message_of(transaction)->head;
    return (have < NEXT) || ((frame[ADDRESS] == head[0]) && (frame[COMMAND] == command_of(head)));
}

static fathom_status_t parse_response(fathom_transaction_t *transaction, const uint8_t *frame)
{
    fathom_modbus_message_t *const message = &((fathom_modbus_request_t *)transaction)->message;
    if (frame[COMMAND] != command_of(message->head)) return FATHOM_ERR_MALFORMED;
    fathom_dyp_55aa_decode(frame, message->values);
    message->head[0] = frame[ADDRESS];
    return FATHOM_OK;
}

/* No request may collide: with an 8-bit sum, a damaged request can become the command that sets the address. */
static const fathom_protocol_t protocol = {.encode = encode,
                                           .length = fathom_dyp_55aa_frame_length,
                                           .check = check,
                                           .is_request = is_request,
                                           .parse_response = parse_response,
                                           .address_offset = ADDRESS};

static fathom_status_t start(fathom_line_t *line, fathom_modbus_request_t *request)
{
    if (line->parts->frame_size < FATHOM_DYP_MAX_RESPONSE) return FATHOM_ERR_CAPACITY;
    request->transaction.protocol = &protocol;
    request->transaction.address = request->message.head[0];
    return fathom_line_submit(line, &request->transaction);
}

fathom_status_t fathom_dyp_client_submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const uint8_t *const head = request->message.head;
    if ((head[1] != FATHOM_MODBUS_READ_HOLDING_REGISTERS) || (command_of_read(head) == 0u))
        return FATHOM_ERR_UNSUPPORTED;
    return (head[0] != FATHOM_LINE_ALL_UNITS) ? start(line, request) : FATHOM_ERR_ARGUMENT;
}

fathom_status_t fathom_dyp_client_broadcast_address(fathom_line_t *line, fathom_modbus_request_t *request,
                                                    uint8_t address)
{
    if ((address == FATHOM_LINE_ALL_UNITS) || (address == FATHOM_LINE_ANY_UNIT)) return FATHOM_ERR_ARGUMENT;
    if (fathom_line_is_queued(line, &request->transaction)) return FATHOM_ERR_BUSY;
    fathom_modbus_write_single_register(&request->message, address, ADDRESS_REGISTER, address);
    return start(line, request);
}

fathom_modbus_t fathom_dyp_client(fathom_line_t *line)
{
    const fathom_modbus_t transport = {.line = line, .submit = fathom_dyp_client_submit};
    return transport;
}
