/* SPDX-License-Identifier: MIT */
#include "publish/broker.h"

/* Without OpenSSL's header libmosquitto's own words have to do. */
const char *tls_reason(struct mosquitto *mosq)
{
    (void)mosq;
    return "";
}
