/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/engine/edges.h"

/* edges.h: "Makes it ready", whatever the memory held before. */

static fathom_edges_t edges;
static fathom_capture_t capture;

static void init_on(uint8_t fill)
{
    memset(&edges, fill, sizeof edges);
    fathom_edges_init(&edges, NULL);
    capture = fathom_edges_capture(&edges);
}

static const uint8_t fills[] = {0x00, 0x01, 0xA5, 0xFF};
enum { FILLS = sizeof fills };

TEST(new_edges_hold_no_pulse_and_have_lost_none)
{
    for (unsigned i = 0; i != FILLS; i++) {
        fathom_pulse_t pulse;
        init_on(fills[i]);
        assert_int_equal(capture.take(capture.ctx, &pulse), 0);
        assert_false(pulse.is_high);
        assert_int_equal(edges.lost, 0);
        assert_int_equal(edges.missed, 0);
        assert_int_equal(edges.same_us, FATHOM_EDGES_DEFAULT_SAME_US);
    }
}

/* "the line is taken as low until the first edge": a fall is the end of nothing. */
TEST(a_fall_before_the_first_rise_is_no_pulse)
{
    for (unsigned i = 0; i != FILLS; i++) {
        fathom_pulse_t pulse;
        init_on(fills[i]);
        fathom_edges_feed(&edges, false, 5000);
        assert_int_equal(capture.take(capture.ctx, &pulse), 0);
    }
}
