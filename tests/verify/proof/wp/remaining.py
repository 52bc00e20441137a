# SPDX-License-Identifier: MIT
"""Goals that neither prover discharges: (unit, goal): what shows it instead. It may only get shorter."""
AIR = 'tests/unit/test_pulse_width.c: each tenth of a degree with each width, by the formula; in short one in eight'

ARGUED = {
    ('pulse_width', 'fathom_pulse_width_mm_in_air_assert_product'): AIR,
    ('pulse_width', 'fathom_pulse_width_mm_in_air_assert_whole'): AIR,
    ('pulse_width', 'fathom_pulse_width_mm_in_air_ensures_formula'): AIR,
}
