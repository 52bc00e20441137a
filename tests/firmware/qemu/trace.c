/* SPDX-License-Identifier: MIT */
/*
 * A plugin of QEMU: which instructions of an image were executed, and where each has led. tests/verify/coverage builds it and
 * names a folder in FATHOM_TRACE; ../avr/trace.h says what is kept there. An interrupt that comes after an instruction
 * is one more place to which it has led, so that some are kept of each.
 *
 * Debian has no qemu-plugin.h, so what is used of it stands here (QEMU 7.2, docs/devel/tcg-plugins.rst).
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { QEMU_PLUGIN_CB_NO_REGS };
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*call)(qemu_plugin_id_t, struct qemu_plugin_tb *));
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *block, size_t index);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *instruction);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *instruction,
                                            void (*call)(unsigned, void *), int flags, void *user);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*call)(qemu_plugin_id_t, void *), void *user);

enum { HALFWORDS = 1 << 19, WAYS = 8 }; /* of 1 MiB from `base` on */
__attribute__((visibility("default"))) int qemu_plugin_version = 1;

static uint32_t led_to[HALFWORDS][WAYS]; /* addresses and 1 more: 0 is none */
static uint64_t base, last;
static const char *image = "";

static void executed(unsigned processor, void *user)
{
    const uint64_t at = (uint64_t)(uintptr_t)user, from = last;
    (void)processor;
    last = at;
    if (from < base || from - base >= 2 * (uint64_t)HALFWORDS) return;
    uint32_t *const ways = led_to[(from - base) / 2];
    for (int way = 0; way != WAYS; way++) {
        if (ways[way] == (uint32_t)at + 1) return;
        if (ways[way] != 0) continue;
        ways[way] = (uint32_t)at + 1;
        return;
    }
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb *block)
{
    const size_t count = qemu_plugin_tb_n_insns(block);
    (void)id;
    for (size_t i = 0; i != count; i++) {
        struct qemu_plugin_insn *const instruction = qemu_plugin_tb_get_insn(block, i);
        const uintptr_t at = (uintptr_t)qemu_plugin_insn_vaddr(instruction);
        qemu_plugin_register_vcpu_insn_exec_cb(instruction, executed, QEMU_PLUGIN_CB_NO_REGS, (void *)at);
    }
}

static void over(qemu_plugin_id_t id, void *user)
{
    char path[512];
    (void)id;
    (void)user;
    (void)snprintf(path, sizeof path, "%s/qemu-%ld.trace", getenv("FATHOM_TRACE"), (long)getpid());
    FILE *const file = fopen(path, "w");
    if (file == NULL) abort();
    (void)fprintf(file, "%s\n", image);
    for (uint64_t i = 0; i != HALFWORDS; i++)
        for (int way = 0; way != WAYS && led_to[i][way] != 0; way++)
            (void)fprintf(file, "%" PRIx64 " %" PRIx32 "\n", base + 2 * i, led_to[i][way] - 1);
    (void)fclose(file);
}

int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int count, char **arguments);
__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const void *info,
                                                               int count, char **arguments)
{
    (void)info;
    for (int i = 0; i != count; i++)
        if (strncmp(arguments[i], "image=", 6) == 0) image = strdup(arguments[i] + 6);
    if (strstr(image, "/virt") != NULL || strstr(image, "virt_") != NULL) base = 0x80000000u;
    if (strstr(image, "stm32f4") != NULL) base = 0x08000000u;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, over, NULL);
    return 0;
}
