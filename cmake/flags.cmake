# The one place for flags that change layout or rounding. Everything links skerry_flags.
add_library(skerry_flags INTERFACE)
target_compile_features(skerry_flags INTERFACE cxx_std_20)
# No contraction: the same source gives the same bits in a kernel and in its scalar twin.
target_compile_options(skerry_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off -fno-math-errno -fno-trapping-math -fopenmp-simd>
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # gcc 12 warns of its own AVX-512 headers, of Eigen's moves and of std::string's concatenation (GCC bug 105651);
    # later versions do not.
    target_compile_options(skerry_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Real8 is wider than a register of older machines: how it would be passed does not matter, what passes it is
    # inlined.
    target_compile_options(skerry_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-psabi>)
endif()
if(SKERRY_ARCH)
    include(CheckCXXCompilerFlag)
    target_compile_options(skerry_flags INTERFACE -march=${SKERRY_ARCH})
    check_cxx_compiler_flag("-march=${SKERRY_ARCH} -mprefer-vector-width=512" SKERRY_WIDE_VECTORS)
    if(SKERRY_WIDE_VECTORS)
        target_compile_options(skerry_flags INTERFACE -mprefer-vector-width=512)
    endif()
    # Copies in full registers: a load of 32 bytes waits for stores of 16 bytes, as GCC copies by default. Where
    # registers have 256 bits element forces take half as long again with those.
    check_cxx_compiler_flag("-march=${SKERRY_ARCH} -mmove-max=512 -mstore-max=512" SKERRY_WIDE_MOVES)
    if(SKERRY_WIDE_MOVES)
        target_compile_options(skerry_flags INTERFACE -mmove-max=512 -mstore-max=512)
    endif()
endif()
if(SKERRY_WARNINGS_AS_ERRORS)
    target_compile_options(skerry_flags INTERFACE -Werror)
endif()
target_compile_definitions(skerry_flags INTERFACE EIGEN_NO_AUTOMATIC_RESIZING)
if(SKERRY_NO_CHECKS)
    target_compile_definitions(skerry_flags INTERFACE SKERRY_NO_CHECKS)
endif()
if(SKERRY_CHECK_ACCESS)
    target_compile_definitions(skerry_flags INTERFACE SKERRY_CHECK_ACCESS)
endif()
if(SKERRY_SANITIZE)
    target_compile_options(skerry_flags INTERFACE
        -fsanitize=${SKERRY_SANITIZE} -fno-sanitize=vptr -fno-omit-frame-pointer)
    target_link_options(skerry_flags INTERFACE -fsanitize=${SKERRY_SANITIZE})
    if(SKERRY_SANITIZE MATCHES "undefined")
        target_compile_options(skerry_flags INTERFACE -fno-sanitize-recover=all)
    endif()
endif()
target_include_directories(skerry_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/engine/include)
