# SPDX-License-Identifier: MIT
#
# The functions that fake_modbus.c replaces, in each program that links it: fake_modbus(HELPERS). The linker leads each
# call of FUNCTION to __wrap_FUNCTION, and __real_FUNCTION to FUNCTION.
function(fake_modbus helpers)
    foreach(function IN ITEMS cancel cancel_unit was_polled poll due_us is_queued submit)
        if(BUILD_SHARED_LIBS)
            # The calls within a shared library are linked already. The loader leads them to the function of the program.
            target_link_options(${helpers} INTERFACE
                -Wl,--defsym=fathom_line_${function}=__wrap_fathom_line_${function}
                -Wl,--export-dynamic-symbol=fathom_line_${function})
        else()
            target_link_options(${helpers} INTERFACE -Wl,--wrap=fathom_line_${function})
        endif()
    endforeach()
    if(NOT BUILD_SHARED_LIBS)
        # fake_modbus.c is linked also where only the library calls what it replaces.
        target_link_options(${helpers} INTERFACE -Wl,--undefined=__wrap_fathom_line_poll)
    endif()
    if(BUILD_SHARED_LIBS)
        target_sources(${helpers} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/shared/fake_modbus_real.c)
        target_link_libraries(${helpers} PUBLIC ${CMAKE_DL_LIBS})
    endif()
endfunction()
