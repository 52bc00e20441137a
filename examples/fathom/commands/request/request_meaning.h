/* SPDX-License-Identifier: MIT */
#ifndef REQUEST_MEANING_H
#define REQUEST_MEANING_H

#include "commands/request/request_options.h"

/* What the models say of the request, or of its response (NULL: of the request): the one that the user has named, or
 * all that can have this address. `piece` is what the frame points to. */
void request_mean(decode_frame_t *frame, decode_piece_t *piece, const request_t *request,
                  const uint8_t *response, uint8_t length);

#endif
