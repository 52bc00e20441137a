/* SPDX-License-Identifier: MIT */
/*
 * Clears the driver-enable pin when a request has left, while loop() does something else. This file is linked only if a
 * sketch constructs a port with such a pin (library.properties: dot_a_linkage), so that all others may use the interrupt
 * of Timer0 themselves.
 */
#include "fathom_arduino.h"

namespace fathom
{
namespace arduino
{

struct driver_enable {
    static serial_uart *first; /* of the ports that have sent a request */
    static void started(serial_uart &port);
    static bool release_all();
};

serial_uart *driver_enable::first;

serial_uart::serial_uart(HardwareSerial &serial, uint8_t driver_enable_pin)
    : serial_uart(serial, driver_enable_pin, driver_enable_pin != no_pin ? driver_enable::started : NULL)
{
}

#if defined(TIMER0_COMPA_vect) && defined(OCIE0A) && !defined(FATHOM_ARDUINO_NO_TIMER0)

void driver_enable::started(serial_uart &port)
{
    const serial_uart *known = first;
    while (known != NULL && known != &port) known = known->next_;
    if (known == NULL) {
        const uint8_t before = SREG;
        cli(); /* A pointer has two bytes. */
        port.next_ = first;
        first = &port;
        SREG = before;
    }
    /* Half a round away from the overflow, whose interrupt is the clock's, unless the pin of this compare is a PWM. */
    if ((TCCR0A & _BV(COM0A1)) == 0) OCR0A = 0x80;
    TIMSK0 |= _BV(OCIE0A);
}

bool driver_enable::release_all()
{
    bool is_done = true;
    for (serial_uart *port = first; port != NULL; port = port->next_)
        if (!port->release()) is_done = false;
    return is_done;
}

} // namespace arduino
} // namespace fathom

ISR(TIMER0_COMPA_vect)
{
    if (fathom::arduino::driver_enable::release_all()) TIMSK0 &= static_cast<uint8_t>(~_BV(OCIE0A));
}

#else

void driver_enable::started(serial_uart &port)
{
    port.serial_.flush();
    /* Some cores return from flush() while the last byte is still in the UART, so the time counts too. */
    while (fathom_elapsed_us(static_cast<uint32_t>(micros()), port.since_us_) < port.span_us_) {
    }
    digitalWrite(port.driver_enable_, LOW);
    port.leaving_ = false;
}

} // namespace arduino
} // namespace fathom

#endif
