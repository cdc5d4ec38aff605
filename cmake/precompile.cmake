# With SKERRY_PRECOMPILE the headers that nearly all sources read are read once for the library and once for the tests.
# The presets of the sanitizers do so; the preset dev does not, and there a source finds only what it includes itself.
set(skerry_common_headers
    <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <optional> <span> <string> <vector>
    <Eigen/Geometry>)

# skerry_precompile(name header...): a target whose precompiled headers others use, when they have the same flags.
function(skerry_precompile name)
    if(SKERRY_PRECOMPILE)
        file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
        add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
        target_link_libraries(${name} PRIVATE skerry_flags Eigen3::Eigen)
        target_precompile_headers(${name} PRIVATE ${skerry_common_headers} ${ARGN})
    endif()
endfunction()

# skerry_use_precompiled(target name)
function(skerry_use_precompiled target name)
    if(SKERRY_PRECOMPILE)
        target_precompile_headers(${target} REUSE_FROM ${name})
    endif()
endfunction()
