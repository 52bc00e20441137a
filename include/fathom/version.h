/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_VERSION_H
#define FATHOM_VERSION_H

/**
 * @file
 * @brief The version of Fathom.
 *
 * Fathom uses semantic versioning. Before 1.0 a minor version may change the interface; CHANGELOG.md lists each change.
 *
 * @code
 * #if FATHOM_VERSION_MAJOR == 0 && FATHOM_VERSION_MINOR < 6
 * #error "This program needs Fathom 0.6 or later"
 * #endif
 * @endcode
 */

/** @brief Major version. */
#define FATHOM_VERSION_MAJOR 0
/** @brief Minor version. */
#define FATHOM_VERSION_MINOR 6
/** @brief Patch version: only mistakes were corrected. */
#define FATHOM_VERSION_PATCH 0
/** @brief The three numbers as a string. */
#define FATHOM_VERSION_STRING "0.6.0"

#endif
