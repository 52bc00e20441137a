# SPDX-License-Identifier: MIT
# cmake -DFATHOM=TOOL -DFOLDER=FOLDER -DCHANGES=FILE -P pages.cmake: writes the man pages, which the tool prints.
function(printed path)
    execute_process(COMMAND ${FATHOM} help ${ARGN} OUTPUT_FILE ${path} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(page name)
    printed(${FOLDER}/${name} --man ${ARGN})
    file(READ ${FOLDER}/${name} text)
    string(REPLACE " 1 \"\" " " 1 \"${day}\" " text "${text}")
    file(WRITE ${FOLDER}/${name} "${text}")
    file(ARCHIVE_CREATE OUTPUT ${FOLDER}/man1/${name}.gz PATHS ${FOLDER}/${name} FORMAT raw
        COMPRESSION GZip COMPRESSION_LEVEL 9)
    file(REMOVE ${FOLDER}/${name})
endfunction()

# The day of the latest release.
set(day)
if(EXISTS ${CHANGES})
    file(STRINGS ${CHANGES} releases REGEX "^## .* - [0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]$")
    if(releases)
        list(GET releases 0 day)
        string(REGEX REPLACE ".* - " "" day "${day}")
    endif()
endif()

set(ENV{SOURCE_DATE_EPOCH} 0) # no time in a compressed page
file(REMOVE_RECURSE ${FOLDER}) # the page of a command that is gone
file(MAKE_DIRECTORY ${FOLDER}/man1)
execute_process(COMMAND ${FATHOM} complete "" OUTPUT_VARIABLE commands COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[a-z]+\t" commands "${commands}")
page(fathom.1)
foreach(command IN LISTS commands)
    string(STRIP ${command} command)
    page(fathom-${command}.1 ${command})
endforeach()
