/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/sensor/factory_line.h"

/* HPS-167S 2.3; A16 2(2), 4(3) and 5(2); A05 1(1) and 2(1). */

TEST(an_hps167s_leaves_the_factory_with_19200_8e1)
{
    assert_int_equal(fathom_hps167s_factory_line.baud, 19200);
    assert_int_equal(fathom_hps167s_factory_line.parity, FATHOM_PARITY_EVEN);
    assert_int_equal(fathom_hps167s_factory_line.stop_bits, 1);
}

TEST(an_hps167_has_115200_8n1)
{
    assert_int_equal(fathom_hps167_factory_line.baud, 115200);
    assert_int_equal(fathom_hps167_factory_line.parity, FATHOM_PARITY_NONE);
    assert_int_equal(fathom_hps167_factory_line.stop_bits, 1);
}

TEST(an_a16_has_9600_8n1)
{
    assert_int_equal(fathom_a16_factory_line.baud, 9600);
    assert_int_equal(fathom_a16_factory_line.parity, FATHOM_PARITY_NONE);
    assert_int_equal(fathom_a16_factory_line.stop_bits, 1);
}

TEST(an_a05_has_9600_8n1)
{
    assert_int_equal(fathom_a05_factory_line.baud, 9600);
    assert_int_equal(fathom_a05_factory_line.parity, FATHOM_PARITY_NONE);
    assert_int_equal(fathom_a05_factory_line.stop_bits, 1);
}
