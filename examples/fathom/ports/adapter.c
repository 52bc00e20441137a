/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): realpath */
#include "ports/adapter.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ports/adapter_identity.h"

/* Why an adapter is not found by its identity. */
enum { ADVICE_NONE, ADVICE_NO_SERIAL, ADVICE_COUNTED, ADVICE_SHARED, ADVICE_DOUBTFUL, ADVICE_PATH };

static bool begins_with(const char *text, const char *beginning)
{
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

static bool is_by_path(const adapter_t *adapter)
{
    return begins_with(adapter->wanted, "/dev/serial/by-path/");
}

/* A serial number that makers give to a whole series, such as 0001, 000000 or 123456789: each character repeats the one
 * before it or follows it. */
static bool is_counted(const char *serial)
{
    for (; serial[0] != '\0' && serial[1] != '\0'; serial++) {
        const bool is_wrapped = serial[0] == '9' && (serial[1] == '0' || serial[1] == 'A');
        if (serial[1] != serial[0] && serial[1] != serial[0] + 1 && !is_wrapped) return false;
    }
    return true;
}

static int advice_for(const adapter_t *adapter)
{
    const adapter_identity_t *const known = &adapter->known;
    if (known->vendor[0] == '\0')
        return adapter->was_open && adapter_identity_is_expected(adapter->wanted) ? ADVICE_PATH : ADVICE_NONE;
    if (is_by_path(adapter)) return ADVICE_NONE;
    if (adapter->is_doubtful) return ADVICE_DOUBTFUL;
    if (known->serial[0] == '\0') return ADVICE_NO_SERIAL;
    if (adapter->is_shared) return ADVICE_SHARED;
    return is_counted(known->serial) ? ADVICE_COUNTED : ADVICE_NONE;
}

const char *adapter_advice(adapter_t *adapter)
{
    static const char *const reasons[] = {[ADVICE_NO_SERIAL] = "this adapter has no serial number",
                                          [ADVICE_COUNTED] = "other adapters may have the same serial number",
                                          [ADVICE_SHARED] =
                                              "another adapter has, or may have had, the same serial number"};
    static char text[256];
    const int advice = advice_for(adapter);
    if (advice == adapter->advice) return NULL;
    adapter->advice = advice;
    if (advice == ADVICE_PATH)
        (void)snprintf(text, sizeof text,
                       "nothing is known about this adapter, so any adapter at this path will be read");
    else if (advice == ADVICE_DOUBTFUL)
        (void)snprintf(text, sizeof text, "%s", adapter_find(adapter, adapter->wanted));
    else if (advice != ADVICE_NONE)
        (void)snprintf(text, sizeof text, "%s: use the same USB socket (%s) again", reasons[advice],
                       adapter->known.place);
    return advice != ADVICE_NONE ? text : NULL;
}

/* ---- twins ---- */

static adapter_t *open_ones;

static bool is_twin(const adapter_identity_t *one, const adapter_identity_t *other)
{
    return adapter_identity_is_same(one, other) && strcmp(one->socket, other->socket) != 0;
}

static void note_twin(adapter_t *adapter)
{
    adapter->is_shared = true;
    if (adapter->is_moved) adapter->is_doubtful = true;
}

bool adapter_is_doubtful(const adapter_t *adapter) { return adapter->is_doubtful; }

/* A device file appeared. If what was behind it is gone again, it may have been a twin. */
static void note_new(const char *name)
{
    adapter_identity_t other;
    const bool is_usb = adapter_identity_read(&other, name);
    const bool is_gone = !is_usb && !adapter_identity_is_there(name);
    for (adapter_t *adapter = open_ones; adapter != NULL; adapter = adapter->next) {
        if (!adapter->is_present) continue;
        if (is_gone) adapter->is_shared = true;
        if (is_usb && is_twin(&adapter->known, &other)) note_twin(adapter);
    }
}

static void note_removed(const char *name)
{
    for (adapter_t *adapter = open_ones; adapter != NULL; adapter = adapter->next)
        if (strcmp(adapter_last_name(adapter->path), name) == 0) adapter->is_present = false;
}

static void note_missed(void)
{
    for (adapter_t *adapter = open_ones; adapter != NULL; adapter = adapter->next) adapter->is_shared = true;
}

static const adapter_changes_t changes = {note_new, note_removed, note_missed};

void adapter_watch(fathom_loop_t *loop) { adapter_changes_watch(loop, &changes); }

/* ---- finding ---- */

typedef struct {
    const adapter_t *adapter;
    const adapter_identity_t *wanted;
    adapter_identity_t in_socket; /* vendor "": none */
    adapter_identity_t elsewhere;
    unsigned count; /* of adapters with this identity */
} search_t;

static void examine(void *ctx, const adapter_identity_t *other)
{
    search_t *const search = ctx;
    const bool is_same = adapter_identity_is_same(search->wanted, other);
    const bool is_there = strcmp(search->wanted->socket, other->socket) == 0;
    if (is_same) search->count++;
    if (is_same && !is_there) search->elsewhere = *other;
    if (is_there &&
        (is_same || (is_by_path(search->adapter) && adapter_identity_is_same_port(search->wanted, other))))
        search->in_socket = *other;
}

static search_t search_for(const adapter_t *adapter, const adapter_identity_t *wanted)
{
    search_t search = {.adapter = adapter, .wanted = wanted};
    adapter_identities_each(examine, &search);
    return search;
}

/* Nothing is known yet: the adapter behind the path. */
static const char *find_first(adapter_t *adapter)
{
    char real[PATH_MAX];
    adapter->found = (adapter_identity_t){0};
    adapter->path[0] = '\0';
    if (realpath(adapter->wanted, real) == NULL ||
        !adapter_identity_read(&adapter->found, adapter_last_name(real)))
        return NULL;
    (void)snprintf(adapter->path, sizeof adapter->path, "%s/%s", adapter_dev, adapter_last_name(real));
    if (begins_with(adapter->wanted, "/dev/serial/by-id/") && search_for(adapter, &adapter->found).count > 1)
        return "several adapters have this serial number; name one of them by its path in "
               "/dev/serial/by-path";
    return NULL;
}

const char *adapter_find(adapter_t *adapter, const char *wanted)
{
    adapter_changes_read(&changes);
    if (adapter->wanted == NULL || strcmp(adapter->wanted, wanted) != 0)
        *adapter = (adapter_t){.wanted = wanted};
    if (adapter->known.vendor[0] == '\0') return find_first(adapter);
    const search_t search = search_for(adapter, &adapter->known);
    if (search.count > 1) note_twin(adapter);
    if (adapter->is_doubtful)
        return "another adapter with the same serial number was plugged in after this one had moved to "
               "another "
               "USB socket, so the right one is unknown; start again with its path in /dev/serial/by-path";
    adapter->found = search.in_socket;
    if (search.in_socket.vendor[0] == '\0' && advice_for(adapter) == ADVICE_NONE && !is_by_path(adapter))
        adapter->found = search.elsewhere;
    if (adapter->found.vendor[0] == '\0') return "";
    (void)snprintf(adapter->path, sizeof adapter->path, "%s/%s", adapter_dev, adapter->found.name);
    return NULL;
}

bool adapter_open(adapter_t *adapter)
{
    adapter_identity_t now;
    const adapter_identity_t *const found = &adapter->found;
    adapter->was_open = true;
    if (found->vendor[0] == '\0') return true;
    /* The watch comes before the search, so that no twin is missed. */
    if (!adapter_changes_start()) adapter->is_shared = true;
    if (!adapter_identity_read(&now, adapter_last_name(adapter->path)) ||
        !adapter_identity_is_same(&now, found) || strcmp(now.socket, found->socket) != 0)
        return false;
    if (adapter->known.vendor[0] != '\0' && strcmp(adapter->known.socket, found->socket) != 0)
        adapter->is_moved = true;
    adapter->known = *found;
    if (search_for(adapter, found).count > 1) note_twin(adapter);
    adapter->is_present = true;
    adapter->advice = ADVICE_NONE;
    adapter->next = open_ones;
    open_ones = adapter;
    return true;
}

void adapter_close(adapter_t *adapter)
{
    adapter_t **link = &open_ones;
    adapter_changes_read(&changes);
    while (*link != NULL && *link != adapter) link = &(*link)->next;
    if (*link != NULL) *link = adapter->next;
    adapter->is_present = false;
}
