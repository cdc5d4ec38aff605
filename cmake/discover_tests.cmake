# skerry_discover_tests(TARGET LABEL...): each test case of a Catch2 program becomes a test of ctest, labelled with
# LABELs and with its own tags. Catch2 2.13's own catch_discover_tests knows no tags. This file is also the script that
# runs after the program was linked.
if(NOT CMAKE_SCRIPT_MODE_FILE)
    function(skerry_discover_tests target)
        set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake)
        string(REPLACE ";" "," labels "${ARGN}")
        add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${list} VERBATIM
            COMMAND ${CMAKE_COMMAND} -D TARGET=${target} -D PROGRAM=$<TARGET_FILE:${target}> -D LABELS=${labels}
                    -D LIST=${list} -P ${PROJECT_SOURCE_DIR}/cmake/discover_tests.cmake)
        set(not_built ${target}_is_not_built)
        file(WRITE ${list}.in "if(EXISTS [[${list}]])\n  include([[${list}]])\n"
                              "else()\n  add_test(${not_built} ${not_built})\nendif()\n")
        set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${list}.in)
    endfunction()
    return()
endif()

cmake_minimum_required(VERSION 3.22)

# Sets `out` to the names of the test cases that the Catch2 expression selects.
function(list_test_cases expression out)
    execute_process(COMMAND ${PROGRAM} ${expression} --list-test-names-only
                    OUTPUT_VARIABLE names ERROR_VARIABLE errors RESULT_VARIABLE result)
    # The exit status is the number of tests; only text says that the program could not run.
    if(NOT result MATCHES "^[0-9]+$" OR errors)
        message(FATAL_ERROR "${PROGRAM} does not list its tests: ${result} ${errors}")
    endif()
    string(REGEX REPLACE "\n$" "" names "${names}")
    string(REPLACE ";" "\\;" names "${names}")
    string(REPLACE "\n" ";" names "${names}")
    set(${out} "${names}" PARENT_SCOPE)
endfunction()

string(REPLACE "," ";" LABELS "${LABELS}")
set(tags unit property scene determinism contract accuracy slow)
foreach(tag IN LISTS tags)
    list_test_cases("[${tag}]" cases_${tag})
endforeach()
list_test_cases("*" cases)

set(script "")
foreach(case IN LISTS cases)
    set(labels ${LABELS})
    foreach(tag IN LISTS tags)
        if(case IN_LIST cases_${tag})
            list(APPEND labels ${tag})
        endif()
    endforeach()
    list(REMOVE_DUPLICATES labels)
    string(REGEX REPLACE "([],[\\])" "\\\\\\1" pattern "${case}")
    set(name "[==[${TARGET}: ${case}]==]")
    string(APPEND script "add_test(${name} [==[${PROGRAM}]==] [==[${pattern}]==] -w NoTests)\n"
                         "set_tests_properties(${name} PROPERTIES TIMEOUT 600 LABELS [==[${labels}]==])\n")
endforeach()
file(WRITE ${LIST} "${script}")
