if(SKERRY_PRECOMPILE)
    skerry_precompile(skerry_precompiled)
    set_target_properties(skerry_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()

# skerry_objects(target source...): sources as the objects that the library is put together from.
function(skerry_objects target)
    add_library(${target} OBJECT ${ARGN})
    target_link_libraries(${target} PUBLIC skerry_flags Eigen3::Eigen Threads::Threads)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    get_target_property(unity ${target} UNITY_BUILD)
    if(unity AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # No source is the main file then, whose anonymous names a type may hold.
        target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
endfunction()

# skerry_folder(name source... [KERNELS source...]): the sources of one folder as an object library. KERNELS are those
# that take a step's time: compiled once more for each instruction set of skerry_kernel_sets, whose objects the global
# property skerry_objects_<set> lists.
function(skerry_folder name)
    cmake_parse_arguments(FOLDER "" "" "KERNELS" ${ARGN})
    set(sources ${FOLDER_UNPARSED_ARGUMENTS} ${FOLDER_KERNELS})
    if(NOT sources)
        add_library(skerry_${name} INTERFACE)
        return()
    endif()
    skerry_objects(skerry_${name} ${sources})
    if(SKERRY_PRECOMPILE AND NOT name STREQUAL "jobs")  # which has flags of its own, those of OpenMP
        target_precompile_headers(skerry_${name} REUSE_FROM skerry_precompiled)
        target_compile_options(skerry_${name} PRIVATE ${skerry_precompiled_warnings})
    endif()
    set_property(GLOBAL APPEND PROPERTY skerry_objects $<TARGET_OBJECTS:skerry_${name}>)

    foreach(set IN LISTS skerry_kernel_sets)
        if(FOLDER_KERNELS)
            string(MAKE_C_IDENTIFIER ${set} id)
            skerry_arch_options(options ${set})
            set(CMAKE_UNITY_BUILD ON)  # headers are half of what there is to compile
            skerry_objects(skerry_${name}_${id} ${FOLDER_KERNELS})
            target_compile_options(skerry_${name}_${id} PRIVATE ${options})
            set_property(GLOBAL APPEND PROPERTY skerry_objects_${id} $<TARGET_OBJECTS:skerry_${name}_${id}>)
        endif()
    endforeach()
endfunction()

# skerry_uses(library...): what the library and everything that it is linked into link.
function(skerry_uses)
    set_property(GLOBAL APPEND PROPERTY skerry_uses ${ARGN})
endfunction()
