/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_VERSION_H
#define FATHOM_VERSION_H

/* Semantic versioning: before 1.0 a minor version may change the interface;
 * CHANGELOG.md says what. */
#define FATHOM_VERSION_MAJOR  0
#define FATHOM_VERSION_MINOR  6
#define FATHOM_VERSION_PATCH  0
#define FATHOM_VERSION_STRING "0.6.0"

#endif
