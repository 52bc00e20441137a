# SPDX-License-Identifier: MIT
ROWS = (
    ('interrupt-of-uart-4', 'AN385 3.7: which interrupts the UARTs have', 'firmware/mps2_alone',
     ('tests/firmware/mps2/port/uart.c', '',
      '{(volatile uint32_t *)0x40009000u, 20}};',
      '{(volatile uint32_t *)0x40009000u, 8}};')),
    ('sent-at-once', 'fathom_mps2.h: sent is said a character later', 'firmware/mps2_alone',
     ('tests/firmware/mps2/port/uart.c', 'uart_sent',
      '&& (fathom_elapsed_us(fathom_mps2_clock.now_us(NULL), uart->taken_us) > (CHARACTER_BITS * 1000000u /'
      ' uart->baud))', '')),
)
