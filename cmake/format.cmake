# Targets format, format_check and lint, when the tools are there. Layout differs between versions of clang-format: 14 is the one that counts.
find_program(SKERRY_CLANG_FORMAT NAMES clang-format-14 clang-format)
find_program(SKERRY_RUN_CLANG_TIDY NAMES run-clang-tidy-14 run-clang-tidy)
mark_as_advanced(SKERRY_CLANG_FORMAT SKERRY_RUN_CLANG_TIDY)

set(skerry_code_folders components jobs systems engine examples profiling tests)
if(SKERRY_CLANG_FORMAT)
    list(TRANSFORM skerry_code_folders REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/\\1/*.h" OUTPUT_VARIABLE headers)
    list(TRANSFORM skerry_code_folders REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/\\1/*.cpp" OUTPUT_VARIABLE sources)
    file(GLOB_RECURSE code CONFIGURE_DEPENDS ${headers} ${sources})
    add_custom_target(format COMMAND ${SKERRY_CLANG_FORMAT} -i ${code} VERBATIM)
    add_custom_target(format_check COMMAND ${SKERRY_CLANG_FORMAT} --dry-run -Werror ${code} VERBATIM)
endif()
if(SKERRY_RUN_CLANG_TIDY)
    # Sources of this project alone, not those that the build writes.
    list(JOIN skerry_code_folders "|" folders)
    add_custom_target(lint COMMAND ${SKERRY_RUN_CLANG_TIDY} -quiet -p ${PROJECT_BINARY_DIR} "^${PROJECT_SOURCE_DIR}/(${folders})/" VERBATIM)
endif()
