# SPDX-License-Identifier: MIT
ROWS = (
    ('settles-while-it-bounces', 'contact.h: settle_us without a change', 'unit/test_contact',
     ('src/engine/contact.c', 'look',
      'if (was_clear && contact->is_clear && (contact->is_high == was_high))',
      'if (was_clear && contact->is_clear && (contact->is_high == was_high || contact->settle_us != 0))')),
)
