# SPDX-License-Identifier: MIT
# cmake -DTO=FOLDER -P port/arduino/layout.cmake: makes FOLDER an Arduino library, and FOLDER.zip of it. FOLDER is
# emptied first; its last part is to be Fathom.
#
# Why this is needed: of a library with a src/ folder the Arduino tools put src/ on the include path, and nothing else,
# and compile every source below it. Here the headers are in include/, and src/ has the CRC twice. So:
#     src/fathom_arduino*          the port, whose header sketches include
#     src/fathom/                  include/fathom
#     src/core/                    src/, with one of the two CRCs (fathom_arduino.h says why that one)
#     examples/                    examples/arduino
#     library.properties           which is not at the top of this repository, so that no tool takes that for a library
if(NOT TO MATCHES "/Fathom$")
    message(FATAL_ERROR "TO is \"${TO}\"; it has to be a path that ends in /Fathom")
endif()
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)

file(STRINGS ${root}/include/fathom/version.h version REGEX "^#define FATHOM_VERSION_STRING ")
string(REGEX REPLACE ".*\"(.*)\"" "\\1" version "${version}")
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/library.properties said REGEX "^version=")
if(NOT said STREQUAL "version=${version}")
    message(FATAL_ERROR "library.properties says ${said}, include/fathom/version.h says ${version}")
endif()

file(GLOB sketches ${root}/examples/arduino/*)

file(REMOVE_RECURSE ${TO})
file(COPY ${CMAKE_CURRENT_LIST_DIR}/library.properties ${root}/LICENSE DESTINATION ${TO})
file(COPY ${CMAKE_CURRENT_LIST_DIR}/fathom_arduino.h ${CMAKE_CURRENT_LIST_DIR}/fathom_arduino.cpp
    ${CMAKE_CURRENT_LIST_DIR}/fathom_arduino_driver_enable.cpp
    DESTINATION ${TO}/src)
file(COPY ${root}/include/fathom DESTINATION ${TO}/src FILES_MATCHING PATTERN *.h PATTERN *.hpp)
file(COPY ${root}/src/ DESTINATION ${TO}/src/core FILES_MATCHING PATTERN *.c PATTERN *.h)
file(REMOVE ${TO}/src/core/codec/crc16.c)
file(COPY ${sketches} DESTINATION ${TO}/examples)
get_filename_component(parent ${TO} DIRECTORY)
execute_process(COMMAND ${CMAKE_COMMAND} -E tar cf Fathom.zip --format=zip Fathom
    WORKING_DIRECTORY ${parent} COMMAND_ERROR_IS_FATAL ANY)
message(STATUS "${TO}, for the folder libraries of your sketchbook, and ${TO}.zip, for Sketch > Include Library")
