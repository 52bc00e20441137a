/* SPDX-License-Identifier: MIT */
#include <openssl/ssl.h>

#include "publish/broker.h"

const char *tls_reason(struct mosquitto *mosq)
{
    const SSL *const ssl = mosquitto_ssl_get(mosq);
    const long result = ssl != NULL ? SSL_get_verify_result(ssl) : X509_V_OK;
    return result != X509_V_OK ? X509_verify_cert_error_string(result) : "";
}
