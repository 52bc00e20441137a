# SPDX-License-Identifier: MIT
ROWS = (
    ('measurements-mixed', 'a05_relay_rule.h: a measurement without one of its probes holds',
     'unit/test_a05_relay_rule',
     ('src/sensor/a05_relay_rule.c', 'fathom_a05_relay_rule_sample',
      'rule->missing = rule->probes;',
      'if (rule->missing == 0) rule->missing = rule->probes;')),
)
