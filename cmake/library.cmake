# The libraries. Tests and other programs of this project link skerry_parts, which exports all names. Hosts link
# skerry::static or skerry::shared, which export only the names of public headers. skerry::skerry is one of these two,
# chosen by BUILD_SHARED_LIBS.
get_property(skerry_all_objects GLOBAL PROPERTY skerry_objects)
get_property(skerry_used GLOBAL PROPERTY skerry_uses)
list(REMOVE_DUPLICATES skerry_used)

# The kernels of an instruction set export only the name of their table.
foreach(set IN LISTS skerry_kernel_sets)
    string(MAKE_C_IDENTIFIER ${set} id)
    get_property(objects GLOBAL PROPERTY skerry_objects_${id})
    set(closed ${CMAKE_CURRENT_BINARY_DIR}/kernels_${id}.o)
    skerry_close(${closed} OBJECTS ${objects} KEEP --keep-global-symbol=skerry_kernels_${id})
    list(APPEND skerry_all_objects ${closed})
endforeach()

function(skerry_library target type)
    add_library(${target} ${type} ${ARGN})
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
    target_link_libraries(${target} PUBLIC Eigen3::Eigen PRIVATE Threads::Threads ${skerry_used})
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/engine/include> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
    target_compile_features(${target} PUBLIC cxx_std_20)
endfunction()

skerry_library(skerry_parts STATIC ${skerry_all_objects})

set(skerry_public_objects ${skerry_all_objects})
if(skerry_can_close)
    set(skerry_public_objects ${CMAKE_CURRENT_BINARY_DIR}/skerry.o)
    # Hidden names become local, and so do names of other libraries, such as templates of std.
    skerry_close(${skerry_public_objects} OBJECTS ${skerry_all_objects} KEEP --localize-hidden --wildcard
        --keep-global-symbol=_ZN6skerry* --keep-global-symbol=_ZNK6skerry* --keep-global-symbol=_ZT[ISV]N6skerry*)
else()
    message(STATUS "Inline functions of Eigen can be mixed with a host's: ${skerry_cannot_close}")
endif()
skerry_library(skerry_static STATIC ${skerry_public_objects})
skerry_library(skerry_shared SHARED ${skerry_public_objects})
# Before version 1.0, a minor version may change the interface.
set_target_properties(skerry_shared PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
foreach(type IN ITEMS static shared)
    set_target_properties(skerry_${type} PROPERTIES OUTPUT_NAME skerry EXPORT_NAME ${type})
    add_library(skerry::${type} ALIAS skerry_${type})
endforeach()
if(BUILD_SHARED_LIBS)
    set(skerry_default shared)
else()
    set(skerry_default static)
endif()
add_library(skerry::skerry ALIAS skerry_${skerry_default})

# Skerry does not depend on MPI: programs that use skerry/mpi.h also link skerry::mpi.
if(SKERRY_MPI)
    add_library(skerry_mpi_objects OBJECT jobs/ranks/mpi_ranks.cpp engine/mpi/mpi_ranks.cpp)
    target_link_libraries(skerry_mpi_objects PRIVATE skerry_flags Eigen3::Eigen MPI::MPI_C)
    set_target_properties(skerry_mpi_objects PROPERTIES POSITION_INDEPENDENT_CODE ON)
    add_library(skerry_mpi STATIC $<TARGET_OBJECTS:skerry_mpi_objects>)
    set_target_properties(skerry_mpi PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME mpi)
    target_link_libraries(skerry_mpi PRIVATE MPI::MPI_C)
    add_library(skerry::mpi ALIAS skerry_mpi)
endif()
