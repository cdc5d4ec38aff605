# Code that takes no part in a step (files, reports, the program) is compiled for size: two thirds of the time, and half
# of the size. Sanitizers have one level of optimisation for everything.
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

# skerry_share_headers(target precompiled): the target reads package headers from a target of skerry_precompile.
function(skerry_share_headers target precompiled)
    if(SKERRY_PRECOMPILE)
        target_precompile_headers(${target} REUSE_FROM ${precompiled})
        target_compile_options(${target} PRIVATE ${skerry_precompiled_warnings})
    endif()
endfunction()

# skerry_objects(target source...): sources as the objects that the library is put together from.
function(skerry_objects target)
    add_library(${target} OBJECT ${ARGN})
    target_link_libraries(${target} PUBLIC skerry_flags Eigen3::Eigen Threads::Threads)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    if(SKERRY_UNITY GREATER 12)
        # In larger units gcc inlines less: steps take 3 to 8 % longer. Cold code, below, has units of SKERRY_UNITY.
        set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 12)
    endif()
    get_target_property(unity ${target} UNITY_BUILD)
    if(unity AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # No source is the main file then, whose anonymous names a type may hold.
        target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
endfunction()

# skerry_folder(name source... [COLD source...] [KERNELS source...]): the sources of one folder as object libraries.
# COLD: sources that take no part in a step, as skerry_<name>_cold. KERNELS: sources that take most of a step's time,
# compiled once more for each instruction set of skerry_kernel_sets, whose objects the global property
# skerry_objects_<set> lists.
function(skerry_folder name)
    cmake_parse_arguments(FOLDER "" "" "COLD;KERNELS" ${ARGN})
    set(sources ${FOLDER_UNPARSED_ARGUMENTS} ${FOLDER_KERNELS})
    if(FOLDER_COLD)
        skerry_objects(skerry_${name}_cold ${FOLDER_COLD})
        target_compile_options(skerry_${name}_cold PRIVATE ${skerry_cold_options})
        set_target_properties(skerry_${name}_cold PROPERTIES UNITY_BUILD_BATCH_SIZE ${SKERRY_UNITY})
        skerry_share_headers(skerry_${name}_cold skerry_precompiled_cold)
        set_property(GLOBAL APPEND PROPERTY skerry_objects $<TARGET_OBJECTS:skerry_${name}_cold>)
    endif()
    if(NOT sources)
        add_library(skerry_${name} INTERFACE)
        return()
    endif()
    skerry_objects(skerry_${name} ${sources})
    if(NOT name STREQUAL "jobs")  # which has flags of its own, those of OpenMP
        skerry_share_headers(skerry_${name} skerry_precompiled)
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
