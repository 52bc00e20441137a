# SPDX-License-Identifier: MIT
# cmake -DTO=FILE -P topics.cmake: writes topics.txt as a source of C, as numbers, since a string has a greatest length.
file(READ ${CMAKE_CURRENT_LIST_DIR}/topics.txt text HEX)
string(REGEX REPLACE "(..)" "0x\\1," text "${text}")
file(WRITE ${TO} "extern const char topics_text[];\nconst char topics_text[] = {${text}0};\n")
