/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "vectors.h"

/*
 * What wrong bytes on the wire do to the frames of vectors.c that have a sum of 8 bits; test_corruption.c has those
 * with a CRC. One wrong byte always changes the sum of its frame. What can still be taken is another frame: a
 * shorter one at the front, if the command became another, or a request, which a unit hears in a response.
 *
 * So there are three receivers of 55 AA frames. Each looks at every byte of what came as a beginning, which is the
 * most that a receiver can do to find a frame.
 */
typedef bool receiver_t(const vector_t *sent, const uint8_t *bytes, uint8_t have);

static bool takes_any(const uint8_t *bytes, uint8_t have)
{
    const uint8_t length = fathom_dyp_55aa_frame_length(bytes, have);
    return length != 0 && length <= have && fathom_dyp_55aa_is_valid(bytes, length);
}

/* Takes any response: who only listens, or sets an address and does not look at which. */
static bool takes_any_response(const vector_t *sent, const uint8_t *bytes, uint8_t have)
{
    (void)sent;
    for (; have != 0; have--, bytes++)
        if (takes_any(bytes, have)) return true;
    return false;
}

/* Takes the response to what it asked: the address and the command of the frame that was sent, and so its length. */
static bool takes_its_response(const vector_t *sent, const uint8_t *bytes, uint8_t have)
{
    for (; have != 0; have--, bytes++)
        if (takes_any(bytes, have) && bytes[2] == sent->bytes[2] && bytes[3] == sent->bytes[3]) return true;
    return false;
}

static bool is_command(uint8_t byte)
{
    return byte == 0x01 || byte == 0x03 || (byte >= 0x10 && byte <= 0x13);
}

/* A unit on the line, of whatever address: obeys 55 AA ADDRESS COMMAND SUM (A05 2(3)), wherever it hears that. */
static bool hears_a_request(const vector_t *sent, const uint8_t *bytes, uint8_t have)
{
    (void)sent;
    for (; have >= 5; have--, bytes++) {
        const unsigned sum = (unsigned)bytes[0] + bytes[1] + bytes[2] + bytes[3];
        if (bytes[0] == 0x55 && bytes[1] == 0xAA && is_command(bytes[3]) && bytes[4] == (sum & 0xFF))
            return true;
    }
    return false;
}

/* A receiver of FF frames knows how long they are. */
static bool takes_its_frame(const vector_t *sent, const uint8_t *bytes, uint8_t have)
{
    (void)sent;
    return fathom_dyp_stream_is_valid(bytes, have);
}

/* A wrong byte that leaves something to be taken. A list of them ends with END. */
typedef struct {
    uint8_t row, at, byte;
} unrefused_t;

enum { NO_ROW = 0xFF };
#define END                                                                                                  \
    {                                                                                                        \
        NO_ROW, 0, 0                                                                                         \
    }

static const unrefused_t nothing[] = {END};

static unsigned tried;

static bool is_one_bit(unsigned change) { return (change & (change - 1)) == 0; }

/* Every other value of every byte; what is taken has to be the next of the list. Returns how many were. */
static unsigned corrupt(const vector_t *sent, uint8_t row, receiver_t *takes, bool bits,
                        const unrefused_t *list)
{
    uint8_t bytes[VECTOR_BYTES];
    unsigned taken = 0;
    memcpy(bytes, sent->bytes, sizeof bytes);
    for (uint8_t at = 0; at != sent->length; at++) {
        for (unsigned byte = 0; byte != 256; byte++) {
            const unsigned change = byte ^ sent->bytes[at];
            if (change == 0 || (bits && !is_one_bit(change))) continue;
            tried++;
            bytes[at] = (uint8_t)byte;
            if (!takes(sent, bytes, sent->length)) continue;
            assert_int_equal(list[taken].row, row);
            assert_int_equal(list[taken].at, at);
            assert_int_equal(list[taken].byte, byte);
            taken++;
        }
        bytes[at] = sent->bytes[at];
    }
    return taken;
}

/* Over all rows of 55 AA frames that go in `direction`. */
static unsigned corrupt_rows(uint8_t direction, receiver_t *takes, bool bits, const unrefused_t *list)
{
    unsigned taken = 0;
    tried = 0;
    for (uint8_t row = 0; row != DYP_ROWS; row++)
        if ((dyp_vectors[row].frame.direction & direction) != 0)
            taken += corrupt(&dyp_vectors[row].frame, row, takes, bits, list + taken);
    return taken;
}

/* So many are taken of those with one wrong bit, and of those with one wrong byte, in rows of so many bytes. */
static void expect_taken(unsigned of_bits, unsigned of_bytes, uint8_t direction, unsigned bytes,
                         receiver_t *takes, const unrefused_t *list)
{
    assert_int_equal(corrupt_rows(direction, takes, true, list), of_bits);
    assert_int_equal(tried, 8 * bytes);
    assert_int_equal(corrupt_rows(direction, takes, false, list), of_bytes);
    assert_int_equal(tried, 255 * bytes);
}

/* Bytes of the tables: FF frames 4 + 10; 55 AA requests 5 + 5 + 5, responses 13 + 7 + 5. The last of each is one
 * frame. */
enum { FF_BYTES = 14, REQUEST_BYTES = 15, RESPONSE_BYTES = 25, DYP_BYTES = 35 };

enum { REQUEST_ALL = 0, RESPONSE_ALL = 1, REQUEST_ONE = 2, RESPONSE_ONE = 3, ADDRESS_5 = 4 }; /* rows */

TEST(every_frame_without_an_error_is_taken_by_whom_it_is_meant_for)
{
    unsigned bytes = 0;
    for (unsigned i = 0; i != AUTO_ROWS; i++) {
        const vector_t *const frame = &auto_vectors[i].frame;
        assert_true(takes_its_frame(frame, frame->bytes, frame->length));
        bytes += frame->length;
    }
    assert_int_equal(bytes, FF_BYTES);
    bytes = 0;
    for (unsigned i = 0; i != DYP_ROWS; i++) {
        const vector_t *const frame = &dyp_vectors[i].frame;
        const bool is_response = (frame->direction & VECTOR_RESPONSE) != 0;
        assert_int_equal(takes_its_response(frame, frame->bytes, frame->length), is_response);
        assert_int_equal(takes_any_response(frame, frame->bytes, frame->length), is_response);
        assert_int_equal(hears_a_request(frame, frame->bytes, frame->length),
                         (frame->direction & VECTOR_REQUEST) != 0);
        bytes += frame->length;
    }
    assert_int_equal(bytes, DYP_BYTES);
    assert_int_equal(dyp_vectors[RESPONSE_ALL].frame.length, 13);
    assert_int_equal(dyp_vectors[RESPONSE_ONE].frame.length, 7);
}

TEST(every_single_bit_and_byte_error_in_a_frame_of_its_own_accord_is_refused)
{
    for (unsigned bits = 0; bits != 2; bits++) {
        tried = 0;
        for (uint8_t i = 0; i != AUTO_ROWS; i++)
            assert_int_equal(corrupt(&auto_vectors[i].frame, i, takes_its_frame, bits != 0, nothing), 0);
        assert_int_equal(tried, (bits != 0 ? 8 : 255) * FF_BYTES);
    }
}

TEST(every_single_bit_and_byte_error_in_a_55_AA_request_is_refused_by_all_units)
{
    expect_taken(0, 0, VECTOR_REQUEST, REQUEST_BYTES, hears_a_request, nothing);
}

TEST(no_single_bit_or_byte_error_makes_a_55_AA_frame_a_response_to_what_was_asked)
{
    expect_taken(0, 0, VECTOR_RESPONSE, RESPONSE_BYTES, takes_its_response, nothing);
    /* Nor a request that comes back as an echo. */
    expect_taken(0, 0, VECTOR_REQUEST, REQUEST_BYTES, takes_its_response, nothing);
}

/*
 * One does leave a response to something else, and it takes no more than one bit:
 *   55 AA 01 01 03 ..   command 01 -> 03 leaves 55 AA 01 03 03, and 55 + AA + 01 + 03 = 103
 * No other: by the command alone another length can come. In the response with four distances 10 to 13 would need
 * 55 + AA + 01 + 1n + 03 + E8 = 1FB to 1FE to end in the seventh byte, 07. In that of probe 1 command 03 would need
 * a fifth byte of 03, which is 07; 11 to 13 leave the length, and the sum wrong by 1 to 3; 01 needs 13 bytes. In a
 * frame of 5 bytes, 03 leaves the length and the others need more bytes.
 */
TEST(one_bit_of_a_55_AA_response_makes_it_a_response_to_set_address)
{
    static const unrefused_t list[] = {{RESPONSE_ALL, 3, 0x03}, END};
    expect_taken(1, 1, VECTOR_BOTH, DYP_BYTES, takes_any_response, list);
}

/*
 * What the other units on the line can take a damaged response for, by its first five bytes:
 *   55 AA 01 01 03 ..   55 + AA + a + 01 = 100 + a: address 01 -> 03 asks unit 3 for all probes      one bit
 *                       command 01 -> 03 is the one above, and sets the address of all units to 1     one bit
 *                       03 -> 01 asks unit 1 for all probes again                                     one bit
 *   55 AA 01 10 07 ..   55 + AA + a + 10 = 10F + a: address 01 -> F8 asks unit F8 for probe 1
 *                       07 -> 10 asks unit 1 for probe 1 again
 * Any other command but 07, which there is not, has another sum.
 */
TEST(five_wrong_bytes_make_a_response_a_request_and_three_of_them_are_one_bit)
{
    static const unrefused_t list[] = {
        {RESPONSE_ALL, 2, 0x03}, {RESPONSE_ALL, 3, 0x03}, {RESPONSE_ALL, 4, 0x01},
        {RESPONSE_ONE, 2, 0xF8}, {RESPONSE_ONE, 4, 0x10}, END,
    };
    expect_taken(3, 5, VECTOR_RESPONSE, RESPONSE_BYTES, hears_a_request, list);
}
