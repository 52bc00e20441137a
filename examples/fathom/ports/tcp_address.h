/* SPDX-License-Identifier: MIT */
#ifndef TCP_ADDRESS_H
#define TCP_ADDRESS_H

#include <stdbool.h>
#include <stddef.h>

/* tcp:HOST[:PORT] wherever the path of a serial port may stand; an IPv6 address in brackets. */
typedef struct {
    char host[256]; /* the longest name that DNS has */
    char service[6];
} tcp_address_t;

/* Is the path one over TCP, right or wrong? */
bool tcp_names(const char *path);

/* NULL, or what is wrong with it. */
const char *tcp_parse(const char *path, tcp_address_t *address);

/*
 * Connects: the descriptor, which does not wait; or -1, and what happened and what to try is in `text`, and whether
 * that may pass by itself in *may_pass. Takes TCP_CONNECT_S for each address of the host at most, less when the user
 * ends the command; looking up a name takes as long as the system needs.
 */
enum { TCP_CONNECT_S = 5 };
int tcp_connect(const tcp_address_t *address, char *text, size_t capacity, bool *may_pass);

/* The same without waiting (but for the name): it is begun, with one of the host's addresses, another one each turn,
 * from 0. Then: 0, it stands; EINPROGRESS; or why not. */
int tcp_connect_begin(const tcp_address_t *address, unsigned turn, char *text, size_t capacity,
                      bool *may_pass);
int tcp_connect_look(int fd);

/* In words: what happened and what to try. */
void tcp_connect_text(int error, char *text, size_t capacity);

#endif
