/* SPDX-License-Identifier: MIT */
#ifndef STATUS_H
#define STATUS_H

/* The exit statuses of every command. */
enum {
    STATUS_OK = 0,
    STATUS_FAILED = 1, /* the line, the port or the output failed */
    STATUS_USAGE = 2,
    STATUS_ALARM = 3 /* `fathom read --until-alarm` alone: an alarm is on */
};

#endif
