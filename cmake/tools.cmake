# Optional tools that make builds faster: a cache of compiled files (ccache) and a linker (mold). They are used only if
# Skerry is the top-level project.
if(NOT PROJECT_IS_TOP_LEVEL)
    return()
endif()

find_program(SKERRY_CCACHE ccache)
find_program(SKERRY_MOLD mold)
mark_as_advanced(SKERRY_CCACHE SKERRY_MOLD)
if(SKERRY_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # ccache needs both sloppiness flags for precompiled headers.
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${SKERRY_CCACHE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
    endif()
endif()
if(SKERRY_MOLD)
    include(CheckLinkerFlag)
    check_linker_flag(CXX -fuse-ld=mold SKERRY_LINKS_WITH_MOLD)
    if(SKERRY_LINKS_WITH_MOLD)
        add_link_options(-fuse-ld=mold)
    endif()
endif()
