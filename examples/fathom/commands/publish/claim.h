/* SPDX-License-Identifier: MIT */
#ifndef CLAIM_H
#define CLAIM_H

#include "mqtt/settings.h"

/*
 * A site is published to a broker once on a computer: a second start would end the connection of the first one again and again.
 *
 * The claim is the name of a socket in Linux's abstract namespace, and not a locked file: a service that can write to no file,
 * and whose /tmp is its own, has the same names as a command in a shell. Any user can have one, and it ends with the process,
 * however that ends.
 */
typedef struct {
    int fd; /* 0: there is no claim */
    uint64_t key;
} claim_t;

/* Claims the site and the broker of *settings instead of those before. False after printing that another process has them;
 * the claim is unchanged then. */
bool claim_site(claim_t *claim, const publish_settings_t *settings);

/* Call it from time to time: frees what other processes have asked. */
void claim_tick(const claim_t *claim);

void claim_end(claim_t *claim);

#endif
