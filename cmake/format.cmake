# Targets that check sources:
#     format, format_check      layout; needs clang-format, whose layout differs between versions: 14 counts
#     lint, lint_changed        clang-tidy over all sources, or over those that changed lately
#     check_includes, check_includes_changed    each file compiles alone, so that a missing include is found
#     check_profiling           the profiling programs compile, for syntax only
# This file is also the script that the targets run: it looks for the files then, so that a new one does not configure
# the build anew.
set(code_folders components jobs systems engine examples profiling tests)
if(CMAKE_SCRIPT_MODE_FILE)
    set(files)
    foreach(folder IN LISTS code_folders)
        file(GLOB_RECURSE found ${SOURCE_DIR}/${folder}/*.h ${SOURCE_DIR}/${folder}/*.cpp)
        list(APPEND files ${found})
    endforeach()
    set(options -i)
    if(CHECK)
        set(options --dry-run -Werror)
    endif()
    execute_process(COMMAND ${CLANG_FORMAT} ${options} ${files} RESULT_VARIABLE status)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "Not formatted. The target `format` does it.")
    endif()
    return()
endif()

find_program(SKERRY_CLANG_FORMAT NAMES clang-format-14 clang-format)
find_program(SKERRY_CLANG_TIDY NAMES clang-tidy-14 clang-tidy)
mark_as_advanced(SKERRY_CLANG_FORMAT SKERRY_CLANG_TIDY)
if(SKERRY_CLANG_FORMAT)
    set(run ${CMAKE_COMMAND} -D CLANG_FORMAT=${SKERRY_CLANG_FORMAT} -D SOURCE_DIR=${PROJECT_SOURCE_DIR})
    add_custom_target(format COMMAND ${run} -D CHECK=OFF -P ${CMAKE_CURRENT_LIST_FILE} VERBATIM)
    add_custom_target(format_check COMMAND ${run} -D CHECK=ON -P ${CMAKE_CURRENT_LIST_FILE} VERBATIM)
endif()
set(checks ${PROJECT_SOURCE_DIR}/scripts/lib)
if(SKERRY_CLANG_TIDY)
    set(run python3 ${checks}/lint.py ${SKERRY_CLANG_TIDY} ${PROJECT_BINARY_DIR})
    add_custom_target(lint COMMAND ${run} --all VERBATIM)
    add_custom_target(lint_changed COMMAND ${run} VERBATIM)
endif()
set(run python3 ${checks}/check_syntax.py ${PROJECT_BINARY_DIR})
add_custom_target(check_includes COMMAND ${run} --all VERBATIM)
add_custom_target(check_includes_changed COMMAND ${run} VERBATIM)
add_custom_target(check_profiling COMMAND ${run} --precompiled profiling VERBATIM)
