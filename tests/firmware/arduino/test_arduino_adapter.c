/* SPDX-License-Identifier: MIT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "board.h"

static void the_adapter_keeps_what_its_header_says(void **state)
{
    (void)state;
    board_t board;
    unsigned held = 0;
    assert_true(board_start(&board, "adapter"));
    for (const board_record_t *record; (record = board_next_record(&board, 200000)) != NULL;) {
        if (record->kind == 1)
            held = record->bytes[0];
        else
            fail_msg("adapter.ino:%d does not hold", record->bytes[0] << 8 | record->bytes[1]);
    }
    assert_true(board.finished);
    assert_int_equal(board.exit_code, 0);
    assert_int_equal(held, 45);
    assert_int_equal(board.usart.overruns, 0);
    board_end(&board);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_adapter_keeps_what_its_header_says)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
