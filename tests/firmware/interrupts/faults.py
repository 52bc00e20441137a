# SPDX-License-Identifier: MIT
"""Faults that run.py --self-test plants: name, what it is, the scenarios that see it, how far they have to go (as QUICK
of the machine has it), and edits: file, regular expression, new text. Each has to be found exactly once."""

CLOCK, PORT, USART = 'port/avr/clock.c', 'port/avr/internal/avr_port.h', 'port/avr/usart0.c'
EDGES = 'src/engine/edges.c'
# The ring with indices of 16 bits, which count all bytes.
C_RING = '''ISR(USART_RX_vect)
{
    const uint8_t state = (uint8_t)(UCSR0A | dropped);
    const uint16_t in = fathom_avr_rx_in;
    ring[2 * in % RING] = UDR0;
    ring[2 * in % RING + 1] = state;
    const bool is_full = (uint16_t)(in - fathom_avr_rx_out) == FATHOM_AVR_RX_RING - 1;
    if (!is_full) fathom_avr_rx_in = in + 1;
    dropped = is_full ? _BV(DOR0) : 0;
}
'''

RP2040, SERIAL = 'port/rp2040/uart.c', 'port/serial/fathom_serial.h'

FAULTS = {'avr': (
    ('clock-without-overflow', 'an overflow that waits is not looked at', ['now_carry'], 1,
     ((CLOCK, r'if \(\(TIFR1 & _BV\(TOV1\)\).*;', ''),)),
    ('clock-in-halves', 'the clock is read with interrupts on', ['now_carry'], 1,
     ((CLOCK, r'cli\(\);', ''),)),
    ('index-of-16-bits', 'the index of the ring is read in halves', ['read_one_wraps'], 1,
     ((PORT, r'uint8_t fathom_avr_rx_in,', 'uint16_t fathom_avr_rx_in,'),
      (CLOCK, r'uint8_t fathom_avr_rx_in,', 'uint16_t fathom_avr_rx_in,'),
      (USART, r'(?s)ISR\(USART_RX_vect, ISR_NAKED\)\n\{.*?\n\}\n', C_RING),
      (USART, r'uint8_t out = fathom_avr_rx_out;',
       'uint16_t out = fathom_avr_rx_out;\n    const uint16_t in = fathom_avr_rx_in;'),
      (USART, r'out != fathom_avr_rx_in', 'out != in'),
      (USART, r'ring\[out \+ 1\]', 'ring[2 * out % RING + 1]'),
      (USART, r'ring\[out\]', 'ring[2 * out % RING]'),
      (USART, r'out = \(uint8_t\)\(out \+ 2\) & \(RING - 1\);', 'out = (uint16_t)(out + 1);'))),
    ('place-given-back-before-it-is-read', 'the place of a byte is free before the byte is taken from it',
     ['read_full'], 2,
     ((USART, r'const uint8_t state = ring\[out \+ 1\] & ERROR;',
       'fathom_avr_rx_out = (uint8_t)(out + 2) & (RING - 1); const uint8_t state = ring[out + 1] & ERROR;'),)),
    ('pulse-given-back-before-it-is-read', 'the place of a pulse is free before the pulse is taken from it',
     ['take_int0_full'], 1,
     ((EDGES, r'const uint8_t at = taken', 'edges->taken = (uint8_t)(taken + 1);\n\\g<0>'),)),
    ('pulses-looked-at-twice', 'take says that all have been taken that are there, after it has looked',
     ['take_int0_high'], 1,
     ((EDGES, r'return 1;\n    \}\n    return 0;',
       'return 1;\n    }\n    edges->taken = edges->written;\n    return 0;'),)),
    ('driver-off-by-an-old-transmit-complete', 'a transmit complete from before the byte turns the driver off',
     ['sent_leaving'], 1,
     ((USART, r'UCSR0A = \(uint8_t\)\(\(UCSR0A & _BV\(U2X0\)\) \| _BV\(TXC0\)\);', ''),)),
    ('driver-off-when-empty', 'the driver is off when the last byte has been handed out', ['write_one'], 1,
     ((USART, r'if \(--left == 0\) UCSR0B', 'if (left == 1) drive(false);\n    if (--left == 0) UCSR0B'),)),
    ('driver-not-as-a-whole', 'an output pin beside the driver is changed with interrupts on', ['pin_high'], 1,
     (('port/avr/pin.c', r'cli\(\);', ''),)),
    ('slept-through', 'an interrupt comes between the look and the sleep', ['idle_last_leaving'], 1,
     (('port/avr/idle.c', r'sleep_cpu\(\);', '__asm__ volatile("nop"); sleep_cpu();'),)),
    ('pointer-in-halves', 'what edges are fed to is stored in halves with interrupts on', ['icp1_begin'], 1,
     (('port/avr/icp1.c', r'(?s)(cli\(\);.*?)    captured = edges;[^\n]*\n', r'captured = edges;\n    \1'),)),
), 'rp2040': (
    ('ring-before-fifo', 'read looks into the ring before the FIFO', ['read_one'], 1,
     ((RP2040, r'\(\(hardware->fr & RP2040_UART_FR_RXFE\) != 0u\) && \(taken == uart->written\)',
       '(taken == uart->written) && ((hardware->fr & RP2040_UART_FR_RXFE) != 0u)'),)),
    ('gather-unmasked', 'read moves bytes to the ring with RECEIVE let through', ['read_three'], 1,
     ((RP2040, r'rp2040_clear\(&hardware->imsc, RECEIVE\);\n    keep_order', 'keep_order'),)),
    ('driver-before-the-request', 'the driver is on before an alarm finds the request unsent', ['write_gone'], 1,
     ((RP2040, r'    uart->given = 0;\n    uart->length = \(uint8_t\)length;\n    drive\(uart, true\);',
       '    drive(uart, true);\n    uart->given = 0;\n    uart->length = (uint8_t)length;'),)),
    ('fed-by-both', 'the transmit interrupt is let through while write fills the FIFO', ['write_most'], 1,
     ((RP2040, r'    drive\(uart, true\);\n    feed\(uart\);',
       '    drive(uart, true);\n    rp2040_set(&hardware_of(uart)->imsc, RP2040_UART_INT_TX);\n    feed(uart);'),)),
    ('alarm-that-has-passed', 'an alarm that has passed meanwhile is not seen', ['write_one'], 1,
     (('port/rp2040/alarm.c', r'    if \(is_over &&.*\n', '    (void)is_over, (void)bit;\n'),)),
    ('slept-through', 'the look at the news and the sleep are not one', ['idle'], 1,
     (('port/rp2040/idle.c', r'    __asm__ volatile\("cpsid i" ::: "memory"\);\n', ''),)),
    ('pulse-given-back-before-it-is-read', 'the place of a pulse is free before the pulse is taken from it',
     ['take_full_and_high'], 1,
     ((EDGES, r'const uint8_t at = taken', 'edges->taken = (uint8_t)(taken + 1);\n\\g<0>'),)),
    ('serial-place-given-back-before-it-is-read', 'the place of a byte is free before the byte is taken from it',
     ['serial_read_full'], 1,
     ((SERIAL, r'bytes\[count\] = serial->bytes', 'serial->got = (uint8_t)(got + 1u);\n        \\g<0>'),)),
    ('serial-looked-at-twice', 'read gives back what came after it had looked', ['serial_read_one'], 1,
     ((SERIAL, r'    serial->got = got;\n    return', '    serial->got = serial->put;\n    return'),)),
)}
