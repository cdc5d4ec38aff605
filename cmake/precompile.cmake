# Headers of packages that nearly all sources include are compiled once: for the tests, and with SKERRY_PRECOMPILE for
# the library too. A missing include of such a header does not show in the build; the target check_includes finds it.
set(skerry_common_headers
    <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <optional> <span> <string> <vector>
    <Eigen/Geometry>)

# From a precompiled header gcc 12 warns of std::string's own copies.
set(skerry_precompiled_warnings "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    set(skerry_precompiled_warnings -Wno-array-bounds -Wno-stringop-overflow)
endif()

# skerry_precompile(name header...): a target whose precompiled headers others use, when they have the same flags:
# target_precompile_headers(target REUSE_FROM name).
function(skerry_precompile name)
    file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
    add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
    target_link_libraries(${name} PRIVATE skerry_flags Eigen3::Eigen)
    target_precompile_headers(${name} PRIVATE ${skerry_common_headers} ${ARGN})
endfunction()
