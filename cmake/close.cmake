# Joins object files into a closed object, which exports only chosen names. Each object file contains its own copies of
# the inline functions and templates that it uses, for example those of Eigen. A linker keeps the first copy of a name,
# even if it was compiled for another instruction set or alignment. The copies in a closed object are local to it.
#
# GNU ld joins the object files, and objcopy makes the names local. Section groups are dissolved, because a linker
# would merge groups of equal names.
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

# skerry_close(OUT OBJECTS object... KEEP option...): adds a rule that joins object files into the closed object OUT.
# KEEP: options of objcopy that select the exported names.
function(skerry_close out)
    cmake_parse_arguments(CLOSE "" "" "OBJECTS;KEEP" ${ARGN})
    cmake_path(GET out FILENAME name)
    add_custom_command(OUTPUT ${out} DEPENDS ${CLOSE_OBJECTS} VERBATIM COMMAND_EXPAND_LISTS
        COMMENT "Closing ${name}" BYPRODUCTS ${out}.open
        COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${out}.open ${CLOSE_OBJECTS}
        COMMAND ${CMAKE_OBJCOPY} ${CLOSE_KEEP} ${out}.open ${out})
endfunction()
