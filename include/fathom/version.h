/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_VERSION_H
#define FATHOM_VERSION_H

/* Semantic versioning: before 1.0 a minor version may change the interface, after a deprecation;
 * CHANGELOG.md says what. */
#define FATHOM_VERSION_MAJOR  0
#define FATHOM_VERSION_MINOR  5
#define FATHOM_VERSION_PATCH  0
#define FATHOM_VERSION_STRING "0.5.0"

#endif
