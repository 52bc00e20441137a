# SPDX-License-Identifier: MIT
ROWS = (
    ('ring-of-256', 'fathom_serial.h: the size is less than 256', 'port/test_serial',
     ('port/serial/fathom_serial.h', '',
      'FATHOM_SERIAL_RING = 128',
      'FATHOM_SERIAL_RING = 256')),
    ('index-too-wide', 'fathom_serial.h: the indices are bytes that wrap by themselves', 'port/test_serial',
     ('port/serial/fathom_serial.h', '',
      'volatile uint8_t put;',
      'volatile uint16_t put;'),
     ('port/serial/fathom_serial.h', 'fathom_serial_put',
      'const uint8_t put = serial->put;',
      'const uint16_t put = serial->put;'),
     ('port/serial/fathom_serial.h', 'fathom_serial_put',
      'serial->put = (uint8_t)(put + 1u);',
      'serial->put = (uint16_t)(put + 1);')),
)
