/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"
#include "vectors.h"

/* One test a row of vectors.c, named by its section, and one for each mistake of the datasheets that concerns
 * these codecs. */

enum { FRAME = 255, GUARD = 0xA5 };

static void fill_in(fathom_modbus_message_t *message, const modbus_meaning_t *meaning, uint16_t *values)
{
    const uint8_t unit = meaning->unit;
    memset(message, GUARD, sizeof *message);
    if (meaning->function == 0x03)
        fathom_modbus_read_holding_registers(message, unit, meaning->address, (uint8_t)meaning->operand,
                                             values);
    else if (meaning->function == 0x06)
        fathom_modbus_write_single_register(message, unit, meaning->address, meaning->operand);
    else
        fathom_modbus_write_multiple_registers(message, unit, meaning->address, (uint8_t)meaning->operand,
                                               values);
}

static void assert_head(const fathom_modbus_message_t *message, const modbus_meaning_t *meaning)
{
    assert_int_equal(message->head[0], meaning->unit);
    assert_int_equal(message->head[1], meaning->function);
    assert_int_equal(message->head[2] * 256 + message->head[3], meaning->address);
    assert_int_equal(message->head[4] * 256 + message->head[5], meaning->operand);
}

static void assert_length_and_crc(const vector_t *frame, uint8_t (*length_of)(const uint8_t *, uint8_t))
{
    assert_int_equal(length_of(frame->bytes, frame->length), frame->length);
    assert_int_equal(fathom_crc16(frame->bytes, frame->length), 0);
}

static void request_row(const modbus_vector_t *row)
{
    uint8_t frame[FRAME];
    uint16_t values[VECTOR_VALUES] = {0};
    fathom_modbus_message_t message;

    memset(frame, GUARD, sizeof frame);
    fill_in(&message, &row->meaning, values);
    assert_int_equal(fathom_modbus_rtu_encode_request(&message, frame), row->frame.length);
    assert_memory_equal(frame, row->frame.bytes, row->frame.length);
    assert_int_equal(frame[row->frame.length], GUARD);

    assert_length_and_crc(&row->frame, fathom_modbus_rtu_request_length);
    memset(&message, GUARD, sizeof message);
    message.values = values;
    assert_int_equal(fathom_modbus_rtu_parse_request(&message, row->frame.bytes, VECTOR_VALUES), FATHOM_OK);
    assert_head(&message, &row->meaning);
    assert_int_equal(message.exception, 0);
}

static void response_row(const modbus_vector_t *row)
{
    const modbus_meaning_t *const meaning = &row->meaning;
    uint8_t frame[FRAME];
    uint16_t values[VECTOR_VALUES] = {0};
    fathom_modbus_message_t message;

    assert_length_and_crc(&row->frame, fathom_modbus_rtu_response_length);
    fill_in(&message, meaning, values);
    assert_int_equal(fathom_modbus_rtu_parse_response(&message, row->frame.bytes),
                     meaning->exception != 0 ? FATHOM_ERR_EXCEPTION : FATHOM_OK);
    assert_int_equal(message.exception, meaning->exception);
    assert_memory_equal(values, meaning->values, sizeof values);
    assert_head(&message, meaning);

    memset(frame, GUARD, sizeof frame);
    memcpy(values, meaning->values, sizeof values);
    fill_in(&message, meaning, values);
    message.exception = meaning->exception;
    assert_int_equal(fathom_modbus_rtu_encode_response(&message, frame), row->frame.length);
    assert_memory_equal(frame, row->frame.bytes, row->frame.length);
    assert_int_equal(frame[meaning->function == 0x03 ? 5 + 2 * meaning->operand : 8], GUARD);
}

static void modbus_row(void **state)
{
    const modbus_vector_t *const row = *state;
    assert_true(row->frame.direction != 0);
    if ((row->frame.direction & VECTOR_REQUEST) != 0) request_row(row);
    if ((row->frame.direction & VECTOR_RESPONSE) != 0) response_row(row);
}

static void auto_row(void **state)
{
    const auto_vector_t *const row = *state;
    uint8_t frame[FATHOM_DYP_MAX_LENGTH + 1];
    uint16_t values[FATHOM_DYP_PROBES] = {0};

    assert_true(fathom_dyp_stream_is_valid(row->frame.bytes, row->frame.length));
    fathom_dyp_stream_decode(row->frame.bytes, values, row->probes);
    assert_memory_equal(values, row->values, sizeof values);

    memset(frame, GUARD, sizeof frame);
    assert_int_equal(fathom_dyp_stream_encode(frame, row->values, row->probes), row->frame.length);
    assert_memory_equal(frame, row->frame.bytes, row->frame.length);
    assert_int_equal(frame[row->frame.length], GUARD);
}

static void crc_row(void **state)
{
    const crc_vector_t *const row = *state;
    uint8_t frame[VECTOR_VALUES + 2];
    assert_int_equal(fathom_crc16(row->bytes, row->length), row->value);
    memcpy(frame, row->bytes, row->length);
    memcpy(frame + row->length, row->wire, 2);
    assert_int_equal(fathom_crc16(frame, (uint8_t)(row->length + 2)), 0);
}

/* ---- the tables themselves ---- */

TEST(the_tables_carry_every_printed_frame)
{
    unsigned requests = 0;
    unsigned responses = 0;
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        assert_true(modbus_vectors[i].frame.length >= 5);
        requests += (modbus_vectors[i].frame.direction & VECTOR_REQUEST) != 0;
        responses += (modbus_vectors[i].frame.direction & VECTOR_RESPONSE) != 0;
    }
    assert_int_equal(AUTO_ROWS + MODBUS_ROWS + DYP_ROWS, 38);
    assert_int_equal(requests, 21);
    assert_int_equal(responses, 20);
}

TEST(every_55_AA_frame_goes_both_ways)
{
    for (unsigned i = 0; i != DYP_ROWS; i++) {
        const dyp_vector_t *const row = &dyp_vectors[i];
        uint8_t frame[FRAME];
        memset(frame, GUARD, sizeof frame);
        if ((row->frame.direction & VECTOR_REQUEST) != 0) {
            assert_int_equal(fathom_dyp_55aa_encode_request(frame, row->address, row->command), 5);
            assert_memory_equal(frame, row->frame.bytes, 5);
            assert_int_equal(frame[5], GUARD);
        }
        if ((row->frame.direction & VECTOR_RESPONSE) == 0) continue;
        uint16_t values[5] = {GUARD, GUARD, GUARD, GUARD, GUARD};
        const uint8_t count = fathom_dyp_55aa_value_count(row->command);
        assert_int_equal(fathom_dyp_55aa_response_length(row->command), row->frame.length);
        assert_int_equal(fathom_dyp_55aa_frame_length(row->frame.bytes, row->frame.length),
                         row->frame.length);
        assert_true(fathom_dyp_55aa_is_valid(row->frame.bytes, row->frame.length));
        fathom_dyp_55aa_decode(row->frame.bytes, values);
        assert_memory_equal(values, row->values, count * sizeof *values);
        assert_int_equal(values[count], GUARD);
        assert_int_equal(fathom_dyp_55aa_encode_response(frame, row->address, row->command, row->values),
                         row->frame.length);
        assert_memory_equal(frame, row->frame.bytes, row->frame.length);
        assert_int_equal(frame[row->frame.length], GUARD);
    }
}

/* ---- mistakes in the datasheets ---- */

/* HPS-167S tables 4 and 7: 0 to 252 bytes of data, 0 to 256. The longest response that Modbus knows carries 250
 * bytes of registers and their count. */
TEST(hps_a_response_carries_at_most_251_bytes_of_data)
{
    static const uint8_t longest[] = {0x01, 0x03, 250};
    static const uint8_t longer[] = {0x01, 0x03, 252};
    assert_int_equal(fathom_modbus_rtu_response_length(longest, 3), 255);
    assert_int_equal(fathom_modbus_rtu_response_length(longer, 3), 0);
}

/* ---- all of them ---- */

static suite_test_t rows[AUTO_ROWS + MODBUS_ROWS + CRC_ROWS];

static void add(unsigned at, void (*function)(void **), const void *row, const char *name)
{
    suite_add(&rows[at], &suite, __FILE__, name, function, row);
}

__attribute__((constructor)) static void add_rows(void)
{
    unsigned at = 0;
    for (unsigned i = 0; i != AUTO_ROWS; i++)
        add(at++, auto_row, &auto_vectors[i], auto_vectors[i].frame.name);
    for (unsigned i = 0; i != MODBUS_ROWS; i++)
        add(at++, modbus_row, &modbus_vectors[i], modbus_vectors[i].frame.name);
    for (unsigned i = 0; i != CRC_ROWS; i++) add(at++, crc_row, &crc_vectors[i], crc_vectors[i].source);
}
