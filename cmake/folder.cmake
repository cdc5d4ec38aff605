# Code outside of steps (files, reports, the program) is compiled for size, which takes a third less time and halves the
# size. Builds with sanitizers have one optimisation level.
set(skerry_cold_options "")
if(CMAKE_BUILD_TYPE MATCHES "^Rel" AND NOT SKERRY_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    set(skerry_cold_options -Os)
endif()
if(SKERRY_PRECOMPILE)
    skerry_precompile(skerry_precompiled)
    set(cold_headers "")
    if(TARGET nlohmann_json::nlohmann_json)
        list(APPEND cold_headers <nlohmann/json.hpp>)
    endif()
    skerry_precompile(skerry_precompiled_cold ${cold_headers})
    target_compile_options(skerry_precompiled_cold PRIVATE ${skerry_cold_options})
    target_link_libraries(skerry_precompiled_cold PRIVATE $<TARGET_NAME_IF_EXISTS:nlohmann_json::nlohmann_json>)
    set_target_properties(skerry_precompiled skerry_precompiled_cold PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()

# skerry_share_headers(target precompiled): `target` uses the precompiled headers of a target of skerry_precompile.
function(skerry_share_headers target precompiled)
    if(SKERRY_PRECOMPILE)
        target_precompile_headers(${target} REUSE_FROM ${precompiled})
        target_compile_options(${target} PRIVATE ${skerry_precompiled_warnings})
    endif()
endfunction()

# skerry_objects(target source...): an object library, which becomes part of the library.
function(skerry_objects target)
    add_library(${target} OBJECT ${ARGN})
    target_link_libraries(${target} PUBLIC skerry_flags Eigen3::Eigen Threads::Threads)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    get_target_property(unity ${target} UNITY_BUILD)
    if(unity AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # In a unity build, gcc would warn about each type with members from anonymous namespaces.
        target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
endfunction()

# skerry_folder(name source... [COLD source...] [KERNELS source...]): the sources of one folder as object libraries.
# COLD: sources that steps do not use; they form the object library skerry_<name>_cold. KERNELS: sources that take most
# of a step's time. They are compiled once more for each instruction set of skerry_kernel_sets. The global property
# skerry_objects_<set> lists these objects.
function(skerry_folder name)
    cmake_parse_arguments(FOLDER "" "" "COLD;KERNELS" ${ARGN})
    if(FOLDER_KERNELS AND SKERRY_UNITY GREATER 12)
        set(CMAKE_UNITY_BUILD_BATCH_SIZE 12)  # gcc inlines less in larger units, and steps take 3 to 8 % longer
    endif()
    set(sources ${FOLDER_UNPARSED_ARGUMENTS} ${FOLDER_KERNELS})
    if(FOLDER_COLD)
        skerry_objects(skerry_${name}_cold ${FOLDER_COLD})
        target_compile_options(skerry_${name}_cold PRIVATE ${skerry_cold_options})
        skerry_share_headers(skerry_${name}_cold skerry_precompiled_cold)
        set_property(GLOBAL APPEND PROPERTY skerry_objects $<TARGET_OBJECTS:skerry_${name}_cold>)
    endif()
    if(NOT sources)
        add_library(skerry_${name} INTERFACE)
        return()
    endif()
    skerry_objects(skerry_${name} ${sources})
    if(NOT name STREQUAL "jobs")  # jobs has its own flags, those of OpenMP
        skerry_share_headers(skerry_${name} skerry_precompiled)
    endif()
    set_property(GLOBAL APPEND PROPERTY skerry_objects $<TARGET_OBJECTS:skerry_${name}>)

    foreach(set IN LISTS skerry_kernel_sets)
        if(FOLDER_KERNELS)
            string(MAKE_C_IDENTIFIER ${set} id)
            skerry_arch_options(options ${set})
            set(CMAKE_UNITY_BUILD ON)  # headers are half of the code
            skerry_objects(skerry_${name}_${id} ${FOLDER_KERNELS})
            target_compile_options(skerry_${name}_${id} PRIVATE ${options})
            set_property(GLOBAL APPEND PROPERTY skerry_objects_${id} $<TARGET_OBJECTS:skerry_${name}_${id}>)
        endif()
    endforeach()
endfunction()

# skerry_never_fuse(source...): compiles sources of this folder without the optimisation with which gcc 12 makes fused
# multiply-adds (vfmaddsub) despite -ffp-contract=off. Such instructions would make results depend on the instruction
# set. check_kernels finds them.
function(skerry_never_fuse)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        set_source_files_properties(${ARGN} PROPERTIES
            COMPILE_OPTIONS -fno-tree-slp-vectorize SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
    endif()
endfunction()

# skerry_uses(library...): libraries that Skerry and all programs with Skerry link.
function(skerry_uses)
    set_property(GLOBAL APPEND PROPERTY skerry_uses ${ARGN})
endfunction()
