/* SPDX-License-Identifier: MIT */
#ifndef TCP_ADDRESS_H
#define TCP_ADDRESS_H

#include <stdbool.h>

/* tcp:HOST[:PORT], which may stand for the path of a serial port. An IPv6 address stands in brackets. */
typedef struct {
    char host[256]; /* DNS allows no longer name */
    char service[6];
} tcp_address_t;

/* Does the path begin with tcp: ? */
bool tcp_names(const char *path);

/* Returns NULL, or what is wrong with the path. */
const char *tcp_parse(const char *path, tcp_address_t *address);

#endif
