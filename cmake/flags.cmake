include(CheckCXXCompilerFlag)

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
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The compiler collects garbage only above 600 MB: a sixth less CPU time, 200 MB more memory for the largest units.
    target_compile_options(skerry_flags INTERFACE
        "$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=600000>")
endif()
if(SKERRY_ARCH)
    skerry_arch_options(skerry_arch_flags ${SKERRY_ARCH})
    target_compile_options(skerry_flags INTERFACE ${skerry_arch_flags})
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    # Eigen adds up in packets as wide as registers are, and multiplies and adds in one rounding where it can. Hidden
    # from it that there is more than SSE, packets are two doubles and sums the same bits on every instruction set.
    # Kernels use vector types of the compiler, whose lanes do not care.
    target_compile_options(skerry_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CXX>:-U__AVX__ -U__AVX2__ -U__FMA__ -U__AVX512F__>)
endif()
# Only what public headers declare leaves the library.
target_compile_options(skerry_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fvisibility=hidden -fvisibility-inlines-hidden>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Else variables of inline functions stay one for a whole process, whoever has them.
    target_compile_options(skerry_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fno-gnu-unique>)
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
    # Without the checks of every pointer for null and alignment, which are two fifths of the time to compile: a null
    # pointer ends a program anyhow, and x86 reads what is not aligned.
    set(unchecked vptr,null,alignment)
    if(SKERRY_FUZZERS)
        set(unchecked vptr)  # fuzzers run for hours, and compile once
    endif()
    target_compile_options(skerry_flags INTERFACE
        -fsanitize=${SKERRY_SANITIZE} -fno-sanitize=${unchecked} -fno-omit-frame-pointer)
    target_link_options(skerry_flags INTERFACE -fsanitize=${SKERRY_SANITIZE})
    if(SKERRY_SANITIZE MATCHES "undefined")
        target_compile_options(skerry_flags INTERFACE -fno-sanitize-recover=all)
    endif()
    if(SKERRY_TEST_OBJECTS)
        # Eigen allocates in another way for an address sanitizer, and matrices of tests are freed in the library.
        target_compile_definitions(skerry_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
endif()
target_include_directories(skerry_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/engine/include)
