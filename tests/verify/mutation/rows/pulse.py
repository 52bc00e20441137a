# SPDX-License-Identifier: MIT
ROWS = (
    ('noise-ends-cycle', 'pulse.h: noise is passed over and the capture stays armed', 'unit/test_pulse',
     ('src/engine/pulse.c', 'take',
      'count_one(&meter->noises);',
      'count_one(&meter->noises); meter->waiting = false;')),
    ('cut-wire-is-no-target', 'pulse.h: no pulse is an error', 'unit/test_pulse unit/test_a16_pwm',
     ('src/engine/pulse.c', 'take',
      'if (!pulse.is_high) return FATHOM_ERR_NO_RESPONSE;', ''),
     ('src/engine/pulse.c', 'take',
      'reading->kind = FATHOM_FAULT;',
      'reading->kind = pulse.is_high ? FATHOM_FAULT : FATHOM_NO_TARGET;')),
    ('armed-after-edge', 'pulse.h: a pulse anywhere after the trigger counts', 'unit/test_pulse_trigger',
     ('src/engine/pulse.c', 'fathom_pulse_poll',
      'if (!meter->waiting && fathom_trigger_is_due(trigger)) capture->arm(capture->ctx);', ''),
     ('src/engine/pulse.c', 'fathom_pulse_poll',
      'if (driven == FATHOM_READY) meter->waiting = true;',
      'if (driven == FATHOM_READY) { meter->waiting = true; capture->arm(capture->ctx); }')),
)
