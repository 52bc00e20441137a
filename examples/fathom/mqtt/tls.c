/* SPDX-License-Identifier: MIT */
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include "mqtt/broker.h"

/* An own context, because libmosquitto 2.0 reports that a certificate was not accepted, and not why. */

/* Verifies as OpenSSL does, and stores the error. It may run in the thread that connects. */
static int verify(X509_STORE_CTX *certificate, void *ctx)
{
    const int result = X509_verify_cert(certificate);
    if (result <= 0) *(int *)ctx = X509_STORE_CTX_get_error(certificate);
    return result;
}

static bool set_authorities(SSL_CTX *ssl, const broker_settings_t *settings)
{
    if (settings->ca_file[0] == '\0') return SSL_CTX_set_default_verify_paths(ssl) == 1;
    return SSL_CTX_load_verify_locations(ssl, settings->ca_file, NULL) == 1;
}

static bool set_certificate(SSL_CTX *ssl, const broker_settings_t *settings)
{
    return settings->certificate_file[0] == '\0' ||
           (SSL_CTX_use_certificate_chain_file(ssl, settings->certificate_file) == 1 &&
            SSL_CTX_use_PrivateKey_file(ssl, settings->key_file, SSL_FILETYPE_PEM) == 1 &&
            SSL_CTX_check_private_key(ssl) == 1);
}

/* The certificate must be for the host that the user named. */
static bool set_name(SSL_CTX *ssl, const char *host)
{
    X509_VERIFY_PARAM *const param = SSL_CTX_get0_param(ssl);
    return X509_VERIFY_PARAM_set1_ip_asc(param, host) == 1 ||
           X509_VERIFY_PARAM_set1_host(param, host, 0) == 1;
}

static bool set_up(SSL_CTX *ssl, const broker_settings_t *settings, char *reason, size_t capacity)
{
    const char *what = NULL;
    if (!set_authorities(ssl, settings))
        what = settings->ca_file[0] != '\0' ? settings->ca_file : "the system's authorities";
    else if (!set_certificate(ssl, settings))
        what = settings->certificate_file;
    else if (!set_name(ssl, settings->host) || SSL_CTX_set_min_proto_version(ssl, TLS1_2_VERSION) != 1)
        what = settings->host;
    if (what == NULL) return true;
    const char *const error = ERR_reason_error_string(ERR_peek_last_error());
    (void)snprintf(reason, capacity, "%s cannot be used: %s", what,
                   error != NULL ? error : "no reason is given");
    ERR_clear_error();
    return false;
}

bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, int *error, char *reason,
             size_t capacity)
{
    SSL_CTX *const ssl = SSL_CTX_new(TLS_client_method());
    (void)snprintf(reason, capacity, "there is no memory left");
    if (ssl == NULL) return false;
    SSL_CTX_set_verify(ssl, SSL_VERIFY_PEER, NULL);
    SSL_CTX_set_cert_verify_callback(ssl, verify, error);
    const bool is_good = set_up(ssl, settings, reason, capacity) &&
                         mosquitto_int_option(mosq, MOSQ_OPT_SSL_CTX_WITH_DEFAULTS, 0) == MOSQ_ERR_SUCCESS &&
                         mosquitto_void_option(mosq, MOSQ_OPT_SSL_CTX, ssl) == MOSQ_ERR_SUCCESS;
    SSL_CTX_free(ssl); /* libmosquitto keeps a reference */
    return is_good;
}

const char *tls_reason(int error) { return error != X509_V_OK ? X509_verify_cert_error_string(error) : ""; }
