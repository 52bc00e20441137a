# SPDX-License-Identifier: MIT
# Every test_NAME.py beside the including CMakeLists.txt is a test, firmware.MACHINE_NAME. It finds the images of its
# machine in FATHOM_IMAGES, and what tests/interop has in its own variables.
file(GLOB scripts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test_*.py)
get_filename_component(machine ${CMAKE_CURRENT_SOURCE_DIR} NAME)
foreach(script IN LISTS scripts)
    get_filename_component(name ${script} NAME_WE)
    string(REPLACE "test_" "firmware.${machine}_" name ${name})
    add_test(NAME ${name} COMMAND ${FATHOM_PYTHON} ${script})
    set_tests_properties(${name} PROPERTIES LABELS firmware TIMEOUT ${timeout}
        ENVIRONMENT "${environment};FATHOM_IMAGES=${FATHOM_IMAGES_${machine}}")
endforeach()
