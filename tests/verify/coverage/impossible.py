# SPDX-License-Identifier: MIT
"""What no test executes, with the reasons. These lists may only become shorter."""
OTHER_GLIBC = 'a constant: true from glibc 2.42 on, false before'
SNPRINTF = 'snprintf does not fail if it converts only %s'
ONE_NUMBER = 'EAGAIN and EWOULDBLOCK are one number on Linux'
TWICE = 'untested: a port that has failed and fails again with another errno'
MORE = 'untested: more bytes wait than the line has room for'
SHORT = 'libmodbus reports a short write as EMBBADDATA'

# Of the library and the ports for Linux: (file, what, source text): why. An entry that a test executes fails.
IMPOSSIBLE = {
    ('port/posix/settings.c', 'branch true', 'B9600 == 9600'): OTHER_GLIBC,
    ('port/posix/settings.c', 'branch false', 'B9600 == 9600'): OTHER_GLIBC,
    ('port/gpio/gpio.c', 'branch true', 'length < 0'): SNPRINTF,
    ('port/gpio/gpio.c', 'condition 1', 'length < 0 || (size_t)length >= sizeof gpio->path'): SNPRINTF,
    ('port/libmodbus/error.c', 'branch true', 'errno == EWOULDBLOCK'): ONE_NUMBER,
    ('port/libmodbus/error.c', 'condition 2', 'errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR'): ONE_NUMBER,
    ('port/libmodbus/error.c', 'branch false', 'port->error == FATHOM_LIBMODBUS_OK'): TWICE,
    ('port/libmodbus/rtu.c', 'branch false', '(size_t)waiting < capacity'): MORE,
    ('port/libmodbus/rtu.c', 'condition 2', 'waiting != 0 && (size_t)waiting < capacity'): MORE,
    ('port/libmodbus/rtu.c', 'branch true', 'n < 0'): 'read fails although FIONREAD and poll have just succeeded',
    ('port/libmodbus/rtu.c', 'branch false', 'n < 0'): SHORT,
    ('port/libmodbus/rtu.c', 'condition 1', 'n < 0 && errno != EMBBADDATA'): SHORT,
    ('port/libmodbus/tcp.c', 'branch true', 'fd < 0'): 'the line reads before it writes, and read reports it',
    ('port/libmodbus/tcp.c', 'branch false', 'getsockopt(fd, SOL_SOCKET, SO_COOKIE, &number, &size) == 0'):
        'Linux has SO_COOKIE since 4.6',
}

