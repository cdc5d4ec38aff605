# Package headers that nearly all sources include are precompiled, for the tests and, with SKERRY_PRECOMPILE, for the
# library. The build does not notice if a source lacks the include of such a header; the target check_includes does.
set(skerry_common_headers
    <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <optional> <span> <string> <vector>
    <Eigen/Geometry>)

# With precompiled headers gcc 12 has false warnings about copies of std::string.
set(skerry_precompiled_warnings "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    set(skerry_precompiled_warnings -Wno-array-bounds -Wno-stringop-overflow)
endif()

# skerry_precompile(name header...): a target with precompiled headers. Targets with the same flags can use them:
# target_precompile_headers(target REUSE_FROM name).
function(skerry_precompile name)
    file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
    add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
    target_link_libraries(${name} PRIVATE skerry_flags Eigen3::Eigen)
    target_precompile_headers(${name} PRIVATE ${skerry_common_headers} ${ARGN})
endfunction()
