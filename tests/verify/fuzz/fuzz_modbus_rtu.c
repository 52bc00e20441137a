/* SPDX-License-Identifier: MIT */
#include "fathom/codec/modbus_rtu.h"
#include "fuzz.h"

/*
 * modbus_rtu.h. The first byte says which of the parts, and of the bytes whether their CRC is mended, so that what lies
 * behind it is reached: a response to a request; bytes as a request; a request and its response there and back.
 */
enum { READ = 3, WRITE = 6, WRITE_MANY = 16, EXCEPTION = 0x80, MOST = 255 };

typedef uint8_t (*length_t)(const uint8_t *bytes, uint8_t have);

/* The length of what begins here, with no byte more than it has asked for; 0: nothing does, or it breaks off. */
static uint8_t length_of(length_t length, const uint8_t *bytes, size_t have)
{
    for (size_t i = 1; i <= have;) {
        uint8_t *const seen = fuzz_copy(bytes, i);
        const uint8_t is = length(seen, (uint8_t)i);
        free(seen);
        if (is == 0) return 0;
        if (is <= i) {
            PROMISE(is == i, "modbus_rtu.h: a length is told before that many bytes are there");
            PROMISE(length(bytes, (uint8_t)have) == is, "modbus_rtu.h: more bytes do not change the length");
            return is;
        }
        i = is;
    }
    return 0;
}

static fathom_modbus_message_t any_message(uint16_t *values)
{
    fathom_modbus_message_t message = {.values = values};
    static const uint8_t functions[] = {READ, WRITE, WRITE_MANY};
    message.head[0] = fuzz_byte();
    message.head[1] = functions[fuzz_byte() % 3];
    for (int i = 2; i != 6; i++) message.head[i] = fuzz_byte();
    if (message.head[1] != WRITE) message.head[4] = 0; /* what fills a message in takes counts up to 255 */
    return message;
}

/* MODBUS Application Protocol V1.1b3: 6.3, 6.6, 6.12, 7; and of other units, as the header says. */
static fathom_status_t meaning(const fathom_modbus_message_t *asked, const uint8_t *frame)
{
    if (asked->head[0] != 255 && frame[0] != asked->head[0]) return FATHOM_PENDING;
    if (frame[1] == asked->head[1] + EXCEPTION) return FATHOM_ERR_EXCEPTION;
    if (frame[1] != asked->head[1]) return FATHOM_ERR_MALFORMED;
    if (frame[1] == READ) return frame[2] == 2 * asked->head[5] ? FATHOM_OK : FATHOM_ERR_MALFORMED;
    return memcmp(frame + 2, asked->head + 2, 4) == 0 ? FATHOM_OK : FATHOM_ERR_MALFORMED;
}

static void parse_response(uint8_t *frame)
{
    uint16_t *const values = fuzz_guarded(2 * FATHOM_MODBUS_MAX_READ);
    fathom_modbus_message_t message = any_message(values);
    const fathom_modbus_message_t before = message;
    if (message.head[1] != READ || fathom_modbus_rtu_frame_size(&message) != 0) {
        const fathom_status_t status = fathom_modbus_rtu_parse_response(&message, frame);
        PROMISE(status == meaning(&before, frame), "modbus_rtu.h: what a response means");
        const bool is_read = status == FATHOM_OK && frame[1] == READ;
        const uint8_t count = is_read ? message.head[5] : 0;
        for (uint8_t i = 0; i != count; i++)
            PROMISE(values[i] == fuzz_word_at(frame + 3 + 2 * i), "modbus_rtu.h: the values are the frame's");
        PROMISE(fuzz_is_guard(values + count, 2u * (size_t)(FATHOM_MODBUS_MAX_READ - count)),
                "modbus_rtu.h: nothing else is written");
        PROMISE(memcmp(message.head + 1, before.head + 1, 5) == 0, "modbus_rtu.h: the request stays");
        PROMISE(message.head[0] == (status == FATHOM_OK ? frame[0] : before.head[0]),
                "modbus_rtu.h: a response to any unit puts its address in head[0], nothing else does");
        PROMISE(message.exception == (status == FATHOM_ERR_EXCEPTION ? frame[2] : 0),
                "modbus_rtu.h: exception is set with FATHOM_ERR_EXCEPTION, and only then");
    }
    free(values);
}

static void response(bool is_mended)
{
    fuzz_input_t head = fuzz_input; /* the request's stands before the response's bytes */
    for (int i = 0; i != 6; i++) (void)fuzz_byte();
    size_t have;
    uint8_t *const bytes = fuzz_rest(MOST, &have);
    const uint8_t length = length_of(fathom_modbus_rtu_response_length, bytes, have);
    if (length != 0) {
        PROMISE(length >= 5 && (bytes[1] & 0x7F) != 0, "modbus_rtu.h: a response has 5 bytes at least");
        uint8_t *const frame = fuzz_copy(bytes, length);
        if (is_mended) fuzz_seal(frame, length - 2u);
        fuzz_input = head;
        if (fuzz_crc(frame, length) == 0) parse_response(frame);
        free(frame);
    }
    free(bytes);
}

static void serve(const uint8_t *frame, uint8_t length)
{
    const uint8_t capacity = fuzz_byte();
    uint16_t *const values = fuzz_guarded(2u * capacity);
    fathom_modbus_message_t message = {.values = values, .exception = 77};
    uint8_t answer[MOST];
    const fathom_status_t status = fathom_modbus_rtu_parse_request(&message, frame, capacity);
    PROMISE(memcmp(message.head, frame, 6) == 0, "modbus_rtu.h: the head is the request's");
    if (status == FATHOM_OK) {
        const uint8_t size = fathom_modbus_rtu_frame_size(&message);
        PROMISE(message.exception == 0 && size >= length, "modbus_rtu.h: what is served has a size");
        uint8_t *const again = fuzz_guarded(size);
        PROMISE(fathom_modbus_rtu_encode_request(&message, again) == length &&
                    memcmp(again, frame, length) == 0,
                "modbus_rtu.h: what was read as a request is written as the same bytes");
        free(again);
    } else {
        PROMISE(status == FATHOM_ERR_EXCEPTION && (message.exception == 1 || message.exception == 3),
                "modbus_rtu.h: 1 for another function, 3 for a count");
        PROMISE((message.exception == 1) == (frame[1] != READ && frame[1] != WRITE && frame[1] != WRITE_MANY),
                "modbus_rtu.h: 1 for another function");
        PROMISE(fuzz_is_guard(values, 2u * capacity), "modbus_rtu.h: a refused request writes no values");
        PROMISE(fathom_modbus_rtu_encode_response(&message, answer) == 5 && answer[0] == frame[0] &&
                    answer[1] == (frame[1] | EXCEPTION) && answer[2] == message.exception &&
                    fuzz_crc(answer, 5) == 0,
                "modbus_rtu.h: the exception response");
    }
    free(values);
}

static void request(bool is_mended)
{
    fuzz_input_t capacity = fuzz_input;
    (void)fuzz_byte();
    size_t have;
    uint8_t *const bytes = fuzz_rest(MOST, &have);
    const uint8_t length = length_of(fathom_modbus_rtu_request_length, bytes, have);
    if (length != 0) {
        uint8_t *const frame = fuzz_copy(bytes, length);
        if (is_mended) fuzz_seal(frame, length - 2u);
        fuzz_input = capacity;
        if (fuzz_crc(frame, length) == 0) serve(frame, length);
        free(frame);
    }
    free(bytes);
}

/* Out of a message, over the wire, and back. */
static void there_and_back(void)
{
    uint16_t sent[256];
    uint16_t got[256];
    uint8_t back[MOST];
    fathom_modbus_message_t asked = any_message(sent);
    const uint8_t count = asked.head[5];
    for (int i = 0; i != count; i++) sent[i] = fuzz_word();
    const uint8_t size = fathom_modbus_rtu_frame_size(&asked);
    const unsigned most = asked.head[1] == READ ? 125 : 123;
    PROMISE((size == 0) == (asked.head[1] != WRITE && (count == 0 || count > most)),
            "modbus_rtu.h: 0: the count is out of range");
    if (size == 0) return;
    uint8_t *const frame = fuzz_guarded(size);
    const uint8_t length = fathom_modbus_rtu_encode_request(&asked, frame);
    PROMISE(length <= size && size >= 8, "modbus_rtu.h: frame_size is that of the longer of both");
    PROMISE(fuzz_crc(frame, length) == 0, "modbus_rtu.h: with its CRC");
    PROMISE(fathom_modbus_rtu_is_request(&asked, frame, length),
            "modbus_rtu.h: the request begins like itself");
    fathom_modbus_message_t served = {.values = got};
    if (asked.head[1] < EXCEPTION)
        PROMISE(length_of(fathom_modbus_rtu_request_length, frame, length) == length,
                "modbus_rtu.h: a request has the length that it was written with");
    PROMISE(fathom_modbus_rtu_parse_request(&served, frame, 255) == FATHOM_OK, "modbus_rtu.h: it is served");
    if (asked.head[1] == WRITE_MANY)
        PROMISE(memcmp(got, sent, 2u * count) == 0, "modbus_rtu.h: a write of many carries its values");
    free(frame);
    served.values = sent;
    const uint8_t answered = fathom_modbus_rtu_encode_response(&served, back);
    PROMISE(answered <= size && fuzz_crc(back, answered) == 0 &&
                length_of(fathom_modbus_rtu_response_length, back, answered) == answered,
            "modbus_rtu.h: the response has its length and CRC");
    memset(got, 0, sizeof got);
    asked.values = got;
    PROMISE(fathom_modbus_rtu_parse_response(&asked, back) == FATHOM_OK, "modbus_rtu.h: it is the response");
    if (asked.head[1] == READ)
        PROMISE(memcmp(got, sent, 2u * count) == 0, "modbus_rtu.h: the values come back");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint8_t part = fuzz_byte();
    if (part % 4 == 0) response((part & 4) != 0);
    if (part % 4 == 1) request((part & 4) != 0);
    if (part % 4 == 2) there_and_back();
    return 0;
}
