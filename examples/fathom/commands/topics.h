/* SPDX-License-Identifier: MIT */
#ifndef TOPICS_H
#define TOPICS_H

#include "cli/help.h"

/* The topics of `fathom help`; a row without a name ends them. */
extern const help_topic_t topics[];

/* Topics that explain a task from its beginning to its end. */
void topic_log(FILE *to);
void topic_publish(FILE *to);
void topic_delivery(FILE *to);
void topic_boxes(FILE *to);
void topic_service(FILE *to);
void topic_commission(FILE *to);
void topic_calibrate(FILE *to);
void topic_backup(FILE *to);
void topic_request(FILE *to);

/* The topic `faults`, in the folder of `fathom sim`. */
void topic_faults(FILE *to);

/* Writes a line for each field of the JSON of `fathom scan`. */
void scan_help_fields(FILE *to);

#endif
