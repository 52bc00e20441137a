# SPDX-License-Identifier: MIT
# fathom_add_port(NAME SOURCES file... [HEADERS folder] [LINK target...] [WARNINGS off|on|errors])
#
# Makes a port: the static library fathom_NAME, which others link as fathom::NAME, and which links fathom::fathom. Ours
# are made by it, and so is one that stands elsewhere: the function is there after add_subdirectory(fathom) and after
# find_package(fathom). port/README.md tells what a port is.
#
#   SOURCES   its C files; relative ones stand in the folder of the caller
#   HEADERS   the folder that its users include from; without it the caller's
#   LINK      what it needs more, another port or a library of the system; its users get that, too
#   WARNINGS  Fathom's own, of GCC and Clang; on, or as errors, or off: those of the project alone. Without it on
#
# A port is below the drivers: its sources, and the headers beside them and in their internal/, include fathom/hal.h,
# codecs and engines, but not fathom/fathom.h and not fathom/sensor/, and nothing of Fathom's src/. That is refused when
# CMake runs.

# What the sources are kept free of, on every compiler that CI uses; fathom_strict() makes them errors.
set_property(GLOBAL PROPERTY FATHOM_WARNINGS -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow
    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes> -Wmissing-declarations -Wcast-align -Wvla)

# fathom_warn(TARGET [option...]): these warnings, and the options, for a target.
function(fathom_warn target)
    if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
        get_property(warnings GLOBAL PROPERTY FATHOM_WARNINGS)
        target_compile_options(${target} PRIVATE ${warnings} ${ARGN})
    endif()
endfunction()

# The folder is the layer, src/README.md.
function(fathom_check_port_layer name)
    foreach(path IN LISTS ARGN)
        file(STRINGS ${path} includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
        foreach(line IN LISTS includes)
            string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*$" "\\1" header "${line}")
            if(header MATCHES "^fathom/(fathom\\.h|sensor/)")
                message(FATAL_ERROR "The port ${name}, ${path}: includes ${header}. A port is below the drivers: it "
                    "may include fathom/hal.h, fathom/codec/ and fathom/engine/")
            elseif(header MATCHES "(^|/)src/(common\\.h|codec/|engine/|sensor/)" OR header MATCHES "_internal\\.h$")
                message(FATAL_ERROR "The port ${name}, ${path}: includes ${header}, which is no public header of "
                    "Fathom. A port may include what is below include/")
            endif()
        endforeach()
    endforeach()
endfunction()

function(fathom_add_port name)
    cmake_parse_arguments(PARSE_ARGV 1 port "" "HEADERS;WARNINGS" "SOURCES;LINK")
    set(target fathom_${name})
    if(port_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "fathom_add_port(${name}): ${port_UNPARSED_ARGUMENTS} is not "
            "understood. fathom_add_port(NAME SOURCES file... [HEADERS folder] [LINK target...] "
            "[WARNINGS off|on|errors])")
    elseif(NOT name MATCHES "^[a-z][a-z0-9_]*$")
        message(FATAL_ERROR "fathom_add_port(${name}): a name is small letters, digits and _")
    elseif(NOT port_SOURCES)
        message(FATAL_ERROR "fathom_add_port(${name}): SOURCES has no file")
    elseif(TARGET fathom::${name} OR TARGET ${target})
        message(FATAL_ERROR "fathom_add_port(${name}): there is fathom::${name} already")
    endif()
    if(NOT port_HEADERS)
        set(port_HEADERS ${CMAKE_CURRENT_SOURCE_DIR})
    endif()
    get_filename_component(folder ${port_HEADERS} ABSOLUTE)

    set(paths)
    foreach(source IN LISTS port_SOURCES)
        get_filename_component(path ${source} ABSOLUTE)
        if(NOT EXISTS ${path})
            message(FATAL_ERROR "fathom_add_port(${name}): there is no ${path}")
        endif()
        get_filename_component(beside ${path} DIRECTORY)
        file(GLOB headers CONFIGURE_DEPENDS ${beside}/*.h ${beside}/internal/*.h)
        list(APPEND paths ${path} ${headers})
    endforeach()
    list(REMOVE_DUPLICATES paths)
    fathom_check_port_layer(${name} ${paths})

    add_library(${target} STATIC ${port_SOURCES})
    add_library(fathom::${name} ALIAS ${target})
    target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${folder}>)
    target_link_libraries(${target} PUBLIC fathom::fathom ${port_LINK})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} FATHOM_LINK "${port_LINK}")
    if(NOT DEFINED port_WARNINGS OR port_WARNINGS STREQUAL "on")
        fathom_warn(${target})
    elseif(port_WARNINGS STREQUAL "errors")
        fathom_warn(${target} -Werror)
    elseif(NOT port_WARNINGS STREQUAL "off")
        message(FATAL_ERROR "fathom_add_port(${name}): WARNINGS is ${port_WARNINGS}; it may be off, on or errors")
    endif()
endfunction()
