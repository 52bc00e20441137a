/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

static const suite_t suite = {.tear_down = board_stop};

TEST(the_adapter_keeps_what_its_header_says)
{
    unsigned held = 0;
    board_start("adapter");
    for (const board_record_t *record; (record = board_next_record(200000)) != NULL;) {
        if (record->kind == 1)
            held = record->bytes[0];
        else
            fail_msg("adapter.ino:%d does not hold", record->bytes[0] << 8 | record->bytes[1]);
    }
    assert_true(board.finished);
    assert_int_equal(board.exit_code, 0);
    assert_int_equal(held, 81);
    assert_int_equal(board.usart.overruns, 0);
}
