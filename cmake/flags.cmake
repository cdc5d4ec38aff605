include(CheckCXXCompilerFlag)

# All flags that change memory layout or rounding. All targets link skerry_flags.
add_library(skerry_flags INTERFACE)
target_compile_features(skerry_flags INTERFACE cxx_std_20)
# Without contraction, a kernel and its scalar version give the same bits.
target_compile_options(skerry_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off -fno-math-errno -fno-trapping-math -fopenmp-simd>
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # gcc 12 has false warnings about its own AVX-512 headers, Eigen and std::string (GCC bug 105651).
    target_compile_options(skerry_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CXX>:-Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Functions with arguments of type Real8, which is wider than a register of older machines, are inlined. So the
    # warning about their calling convention does not matter.
    target_compile_options(skerry_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-psabi>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The compiler collects garbage only above 600 MB, which saves a sixth of its CPU time.
    target_compile_options(skerry_flags INTERFACE
        "$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=600000>")
endif()
if(SKERRY_ARCH)
    skerry_arch_options(skerry_arch_flags ${SKERRY_ARCH})
    target_compile_options(skerry_flags INTERFACE ${skerry_arch_flags})
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    # The order of Eigen's sums, and its use of fused multiply-add, depend on the instruction set. Without these macros
    # Eigen uses SSE only, so its sums have the same bits on every instruction set. Kernels use vector types of the
    # compiler instead.
    target_compile_options(skerry_flags INTERFACE
        $<$<COMPILE_LANGUAGE:CXX>:-U__AVX__ -U__AVX2__ -U__FMA__ -U__AVX512F__>)
endif()
# The library exports only the names that public headers declare.
target_compile_options(skerry_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-fvisibility=hidden -fvisibility-inlines-hidden>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Static variables of inline functions must not be shared with other libraries of the process.
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
    # These checks are off, because they take two fifths of the compile time and most of the run time. A null pointer
    # ends the program without a check, x86 allows unaligned reads, and the address sanitizer finds each access through
    # a pointer that overflowed or left its object. Only the fuzzers, which run for hours, find a local variable that is
    # used after the end of its scope.
    set(unchecked "")
    if(SKERRY_FUZZERS)
        set(unchecked -fno-sanitize=vptr)
    elseif(SKERRY_SANITIZE MATCHES "undefined")
        set(unchecked
            -fno-sanitize=vptr,null,alignment,object-size,pointer-overflow -fno-sanitize-address-use-after-scope)
    endif()
    target_compile_options(skerry_flags INTERFACE
        -fsanitize=${SKERRY_SANITIZE} ${unchecked} -fno-omit-frame-pointer)
    target_link_options(skerry_flags INTERFACE -fsanitize=${SKERRY_SANITIZE})
    if(SKERRY_SANITIZE MATCHES "undefined")
        target_compile_options(skerry_flags INTERFACE -fno-sanitize-recover=all)
    endif()
    if(SKERRY_TEST_OBJECTS)
        # With an address sanitizer Eigen would allocate in another way than in the test objects of `dev`.
        target_compile_definitions(skerry_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
endif()
target_include_directories(skerry_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/engine/include)
