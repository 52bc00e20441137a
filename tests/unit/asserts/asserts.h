/* SPDX-License-Identifier: MIT */
#ifndef ASSERTS_H
#define ASSERTS_H

/* FATHOM_ASSERT for test_asserts.c: counts the checks that fail, and goes on. */
extern unsigned failed_asserts;
#define FATHOM_ASSERT(condition) ((condition) ? (void)0 : (void)failed_asserts++)

#endif
