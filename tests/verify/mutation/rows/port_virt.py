# SPDX-License-Identifier: MIT
ROWS = (
    ('mtime-in-halves', 'fathom_virt.h: the clock does not jump', 'firmware/virt_alone',
     ('tests/firmware/virt/port/clock.c', 'fathom_virt_ticks',
      'if (VIRT_MTIME[1] == high)', '')),
    ('interrupt-not-completed', 'fathom_virt.h: an interrupt for each byte', 'firmware/virt_alone',
     ('tests/firmware/virt/port/uart.c', 'fathom_virt_external_interrupt',
      'VIRT_PLIC_CLAIM = source;', '')),
)
