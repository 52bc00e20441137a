# SPDX-License-Identifier: MIT
ROWS = (
    ('clock-wrap', 'pulse.h: it holds across the wrap of the clock',
     'unit/test_pulse_trigger unit/test_pulse',
     ('src/engine/trigger.c', 'fathom_trigger_look',
      'fathom_elapsed_us(now_us, trigger->polled_us)',
      'now_us > trigger->polled_us ? now_us - trigger->polled_us : 0')),
    ('refusals-add-up', 'trigger.h: refusals of less than a second are never added up', 'unit/test_break_ends',
     ('src/engine/trigger.c', 'hold',
      'trigger->refused = (status != FATHOM_READY) && (status != FATHOM_ERR_PORT);',
      'trigger->refused = was_refused || (status != FATHOM_READY && status != FATHOM_ERR_PORT);'),
     ('src/engine/trigger.c', 'hold',
      'if (!trigger->refused) return status;',
      'if (status == FATHOM_READY || status == FATHOM_ERR_PORT) return status;')),
)
