# SPDX-License-Identifier: MIT
ROWS = (
    ('driver-dropped-early', 'fathom_arduino.h: sent when the time of the request has passed, too',
     'firmware/test_arduino_rs485',
     ('port/arduino/fathom_arduino.cpp', 'serial_uart::release',
      'left_us(since_us_, span_us_) != 0 ||', '')),
)
