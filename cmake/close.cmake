# Closing objects: many become one that shows only what it should. Inline functions and templates, Eigen's before all,
# are compiled into every object that uses them under one name, and a linker takes whichever comes first: one that was
# compiled for other instructions, or with other alignments. In a closed object they are its own.
#
# GNU ld joins the objects (without groups, by whose names sections of others would be taken for the same), objcopy
# takes the names away.
set(skerry_can_close OFF)
set(skerry_cannot_close "no objcopy was found")
if(CMAKE_OBJCOPY AND CMAKE_LINKER)
    execute_process(COMMAND ${CMAKE_LINKER} --help OUTPUT_VARIABLE skerry_linker_help ERROR_QUIET)
    if(skerry_linker_help MATCHES "--force-group-allocation")
        set(skerry_can_close ON)
    else()
        set(skerry_cannot_close "${CMAKE_LINKER} has no --force-group-allocation, as GNU ld has")
    endif()
endif()
if(SKERRY_SANITIZE)
    set(skerry_can_close OFF)
    set(skerry_cannot_close "sanitizers want to see every name")
endif()

# skerry_close(OUT OBJECTS object... KEEP option...): a rule that makes the object file OUT of others.
# KEEP are options of objcopy that say which names stay.
function(skerry_close out)
    cmake_parse_arguments(CLOSE "" "" "OBJECTS;KEEP" ${ARGN})
    cmake_path(GET out FILENAME name)
    add_custom_command(OUTPUT ${out} DEPENDS ${CLOSE_OBJECTS} VERBATIM COMMAND_EXPAND_LISTS
        COMMENT "Closing ${name}" BYPRODUCTS ${out}.open
        COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${out}.open ${CLOSE_OBJECTS}
        COMMAND ${CMAKE_OBJCOPY} ${CLOSE_KEEP} ${out}.open ${out})
endfunction()
