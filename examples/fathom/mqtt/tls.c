/* SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): gmtime_r */
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <time.h>

#include "mqtt/broker.h"

/* An own context, because libmosquitto 2.0 reports that a certificate was not accepted, and not why. */

/* A clock that is wrong looks like a wrong certificate. */
static void explain_time(const X509 *certificate, bool is_early, const char *words, char *text,
                         size_t capacity)
{
    const time_t now = time(NULL);
    char limit[32] = "?";
    char clock[32] = "?";
    struct tm parts;
    if (ASN1_TIME_to_tm(is_early ? X509_get0_notBefore(certificate) : X509_get0_notAfter(certificate),
                        &parts) == 1)
        (void)strftime(limit, sizeof limit, "%Y-%m-%d %H:%M", &parts);
    if (gmtime_r(&now, &parts) != NULL) (void)strftime(clock, sizeof clock, "%Y-%m-%d %H:%M", &parts);
    (void)snprintf(text, capacity,
                   "%s: it is valid %s %s, and this machine's clock says %s (UTC). Set the clock; if it is "
                   "right, the broker needs another certificate",
                   words, is_early ? "from" : "until", limit, clock);
}

/* Verifies as OpenSSL does, and stores what is wrong. It may run in the thread that connects. */
static int verify(X509_STORE_CTX *store, void *ctx)
{
    tls_verdict_t *const verdict = ctx;
    const int result = X509_verify_cert(store);
    const int error = result > 0 ? X509_V_OK : X509_STORE_CTX_get_error(store);
    const X509 *const certificate = X509_STORE_CTX_get_current_cert(store);
    const char *const words = X509_verify_cert_error_string(error);
    const bool is_early = error == X509_V_ERR_CERT_NOT_YET_VALID;
    verdict->error = error;
    if (error == X509_V_OK || error == verdict->error_of_text) return result;
    verdict->error_of_text = error;
    if (certificate != NULL && (is_early || error == X509_V_ERR_CERT_HAS_EXPIRED))
        explain_time(certificate, is_early, words, verdict->text, sizeof verdict->text);
    else
        (void)snprintf(verdict->text, sizeof verdict->text,
                       "%s; the broker needs another one, or ca-file: the authority that has signed it, or "
                       "host: the name that it is for",
                       words);
    return result;
}

/* Returns what of the settings cannot be used; NULL: nothing. */
static const char *set_up(SSL_CTX *ssl, const broker_settings_t *settings)
{
    const char *const authority = settings->ca_file;
    const char *const certificate = settings->certificate_file;
    X509_VERIFY_PARAM *const param = SSL_CTX_get0_param(ssl);
    if (authority[0] == '\0' && SSL_CTX_set_default_verify_paths(ssl) != 1) return "the system's authorities";
    if (authority[0] != '\0' && SSL_CTX_load_verify_locations(ssl, authority, NULL) != 1) return authority;
    if (certificate[0] != '\0' &&
        (SSL_CTX_use_certificate_chain_file(ssl, certificate) != 1 ||
         SSL_CTX_use_PrivateKey_file(ssl, settings->key_file, SSL_FILETYPE_PEM) != 1 ||
         SSL_CTX_check_private_key(ssl) != 1))
        return certificate;
    /* The certificate must be for the host that the user named. */
    if ((X509_VERIFY_PARAM_set1_ip_asc(param, settings->host) != 1 &&
         X509_VERIFY_PARAM_set1_host(param, settings->host, 0) != 1) ||
        SSL_CTX_set_min_proto_version(ssl, TLS1_2_VERSION) != 1)
        return settings->host;
    return NULL;
}

bool tls_set(struct mosquitto *mosq, const broker_settings_t *settings, tls_verdict_t *verdict, char *text,
             size_t capacity)
{
    SSL_CTX *const ssl = SSL_CTX_new(TLS_client_method());
    const char *const what = ssl != NULL ? set_up(ssl, settings) : "TLS";
    const char *const why = ERR_reason_error_string(ERR_peek_last_error());
    if (what == NULL) {
        SSL_CTX_set_verify(ssl, SSL_VERIFY_PEER, NULL);
        SSL_CTX_set_cert_verify_callback(ssl, verify, verdict);
        (void)mosquitto_int_option(mosq, MOSQ_OPT_SSL_CTX_WITH_DEFAULTS, 0);
        (void)mosquitto_void_option(mosq, MOSQ_OPT_SSL_CTX, ssl);
    } else {
        (void)snprintf(text, capacity, "%s cannot be used: %s", what,
                       why != NULL ? why : "no reason is given");
    }
    ERR_clear_error();
    SSL_CTX_free(ssl); /* libmosquitto keeps a reference */
    return what == NULL;
}
