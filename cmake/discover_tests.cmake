# skerry_discover_tests(TARGET): each test case of a Catch2 program becomes a test of ctest, labelled with its tags.
# With SKERRY_TEST_OBJECTS, cases of one source file with the same tags become one test, named after the file: with an
# address sanitizer most cases take less time than the start of the program.
# This file is also the script that runs after the program was linked.
if(NOT CMAKE_SCRIPT_MODE_FILE)
    function(skerry_discover_tests target)
        set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake)
        add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${list} VERBATIM
            COMMAND ${CMAKE_COMMAND} -D TARGET=${target} -D PROGRAM=$<TARGET_FILE:${target}>
                    -D LIST=${list} -D JOIN=$<BOOL:${SKERRY_TEST_OBJECTS}>
                    -P ${PROJECT_SOURCE_DIR}/cmake/discover_tests.cmake)
        set(not_built ${target}_is_not_built)
        file(WRITE ${list}.in "if(EXISTS [[${list}]])\n  include([[${list}]])\n"
                              "else()\n  add_test(${not_built} ${not_built})\nendif()\n")
        set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${list}.in)
    endfunction()
    return()
endif()

cmake_minimum_required(VERSION 3.22)

# One line a test case: its source file, name and tags, separated by tabs (tests/support/main.cpp).
execute_process(COMMAND ${PROGRAM} --list-cases
                OUTPUT_VARIABLE cases ERROR_VARIABLE errors RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR errors)
    message(FATAL_ERROR "${PROGRAM} does not list its tests: ${result} ${errors}")
endif()
string(REGEX REPLACE "\n$" "" cases "${cases}")
# Brackets and semicolons have a meaning in CMake's lists.
string(REPLACE ";" "<semicolon>" cases "${cases}")
string(REPLACE "[" "<open>" cases "${cases}")
string(REPLACE "]" "<close>" cases "${cases}")
string(REPLACE "\n" ";" cases "${cases}")

set(tests "")
foreach(case IN LISTS cases)
    string(REPLACE "\t" ";" labels "${case}")
    list(POP_FRONT labels file case)
    string(REPLACE "<open>" "[" case "${case}")
    string(REPLACE "<close>" "]" case "${case}")
    string(REPLACE "<semicolon>" ";" case "${case}")
    string(REGEX REPLACE "([],[\\])" "\\\\\\1" pattern "${case}")
    set(name "${case}")
    if(JOIN)
        cmake_path(GET file STEM name)
        list(JOIN labels " " tags)
        string(APPEND name ", " "${tags}")
    endif()
    string(MD5 test "${name}")
    if(NOT test IN_LIST tests)
        list(APPEND tests ${test})
        set(name_${test} "${TARGET}: ${name}")
        set(labels_${test} "${labels}")
        set(patterns_${test} "${pattern}")
    else()
        string(APPEND patterns_${test} ",${pattern}")
    endif()
endforeach()

set(script "")
foreach(test IN LISTS tests)
    set(name "[==[${name_${test}}]==]")
    string(APPEND script "add_test(${name} [==[${PROGRAM}]==] [==[${patterns_${test}}]==] -w NoTests)\n"
                         "set_tests_properties(${name} PROPERTIES TIMEOUT 600 LABELS [==[${labels_${test}}]==])\n")
endforeach()
file(WRITE ${LIST} "${script}")
