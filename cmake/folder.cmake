if(SKERRY_PRECOMPILE)
    skerry_precompile(skerry_precompiled)
    set_target_properties(skerry_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()

# skerry_folder(name source...): the sources of one folder as an object library that the library skerry is put together
# from.
function(skerry_folder name)
    if(ARGN)
        add_library(skerry_${name} OBJECT ${ARGN})
        target_link_libraries(skerry_${name} PUBLIC skerry_flags Eigen3::Eigen Threads::Threads)
        set_target_properties(skerry_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
        if(SKERRY_PRECOMPILE AND NOT name STREQUAL "jobs")  # which has flags of its own, those of OpenMP
            target_precompile_headers(skerry_${name} REUSE_FROM skerry_precompiled)
            target_compile_options(skerry_${name} PRIVATE ${skerry_precompiled_warnings})
        endif()
        if(SKERRY_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
            # No source is the main file then, whose anonymous names a type may hold.
            target_compile_options(skerry_${name} PRIVATE -Wno-subobject-linkage)
        endif()
        target_sources(skerry PRIVATE $<TARGET_OBJECTS:skerry_${name}>)
    else()
        add_library(skerry_${name} INTERFACE)
    endif()
endfunction()
