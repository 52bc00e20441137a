# SPDX-License-Identifier: MIT
# Every test_NAME.py beside the including CMakeLists.txt is a test, firmware.MACHINE_NAME. It finds the images of its
# machine in FATHOM_IMAGES, qemu.py in PYTHONPATH, and what tests/tool/interop has in its own variables.
file(GLOB scripts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/test_*.py)
get_filename_component(machine ${CMAKE_CURRENT_SOURCE_DIR} NAME)
foreach(script IN LISTS scripts)
    get_filename_component(name ${script} NAME_WE)
    string(REPLACE "test_" "${machine}_" name ${name})
    fathom_firmware_test(${name} COMMAND ${FATHOM_PYTHON} ${script} DEPENDS firmware_${machine} ${servers})
    if(TARGET fathom_tool)
        add_dependencies(${name} fathom_tool)
    endif()
    set_tests_properties(firmware.${name} PROPERTIES RESOURCE_LOCK realtime # QEMU's clock is the host's
        ENVIRONMENT "${environment};FATHOM_IMAGES=${FATHOM_IMAGES_${machine}};PYTHONPATH=${CMAKE_CURRENT_LIST_DIR}")
endforeach()
