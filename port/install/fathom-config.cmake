# SPDX-License-Identifier: MIT
include("${CMAKE_CURRENT_LIST_DIR}/fathom-targets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/fathom_add_port.cmake")

# The port over libmodbus, if it was built: without libmodbus here there is no fathom::libmodbus.
set(fathom_libmodbus_targets "${CMAKE_CURRENT_LIST_DIR}/fathom-libmodbus-targets.cmake")
if(EXISTS "${fathom_libmodbus_targets}")
    find_package(PkgConfig QUIET)
    if(PKG_CONFIG_FOUND AND NOT TARGET PkgConfig::LIBMODBUS)
        pkg_check_modules(LIBMODBUS QUIET IMPORTED_TARGET GLOBAL libmodbus)
    endif()
    if(TARGET PkgConfig::LIBMODBUS)
        include("${fathom_libmodbus_targets}")
    endif()
endif()
