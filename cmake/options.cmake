# All options of the project. The defaults suit users who build Skerry alone.
set(SKERRY_TESTS ${PROJECT_IS_TOP_LEVEL} CACHE STRING
    "Build the tests: ON, OFF or threads (those of several workers; they need SKERRY_SCENES and no other part)")
option(SKERRY_EXAMPLES "Build the examples, which are tests as well" ${PROJECT_IS_TOP_LEVEL})
option(SKERRY_PROFILING "Build the benchmarks" ${PROJECT_IS_TOP_LEVEL})
option(SKERRY_PROGRAM "Build the program skerry" ON)
option(SKERRY_HDF5 "Contact problems in FCLIB files, series in HDF5 files; needs HDF5" ON)
option(SKERRY_SCENES "Scenes in files; needs nlohmann-json" ON)
option(SKERRY_PAGES "Pages that play a run, and glTF files; needs nlohmann-json, zlib and three.js" ON)
option(SKERRY_LIVE "Live view in a browser; needs SKERRY_PAGES and CivetWeb" ${SKERRY_PAGES})
option(SKERRY_MPI "The program can simulate one world on several processes (mpirun, srun); needs MPI" OFF)
option(SKERRY_PYTHON "Build the Python package; needs Python 3.11 with nanobind" OFF)
option(SKERRY_NO_CHECKS "Leave out SKERRY_CHECK" OFF)
option(SKERRY_WARNINGS_AS_ERRORS "Stop at warnings" OFF)
set(SKERRY_ARCH "" CACHE STRING "Instruction set for -march of everything, as native; empty: the compiler's default")
set(SKERRY_INSTRUCTION_SETS "x86-64-v3;x86-64-v4" CACHE STRING
    "Without SKERRY_ARCH: sets that kernels are compiled for besides, the most demanding last; chosen at run time")
set(SKERRY_BACKENDS "tbb;openmp;threads" CACHE STRING "Threading backends to build, the default first")
option(SKERRY_PRECOMPILE "Read package headers once for the library; a missing include of theirs goes unseen" OFF)
set(SKERRY_UNITY 1 CACHE STRING
    "Number of sources of a folder that are compiled as one: faster, and a missing include goes unseen")
option(SKERRY_FUZZERS "Build the fuzzers of the readers (clang only)" OFF)
set(SKERRY_SANITIZE "" CACHE STRING "Sanitizers, for example address,undefined")
set(SKERRY_TEST_OBJECTS "" CACHE PATH "Build folder whose compiled tests are linked; empty: tests are compiled here")

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Kind of build" FORCE)
endif()
if(PROJECT_IS_TOP_LEVEL)
    set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()

# By default, accesses to columns are checked in all builds with assertions (without NDEBUG).
string(TOUPPER "${CMAKE_BUILD_TYPE}" skerry_build_type)
set(skerry_check_access OFF)
if(skerry_build_type AND NOT "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${skerry_build_type}}" MATCHES "-DNDEBUG")
    set(skerry_check_access ON)
endif()
option(SKERRY_CHECK_ACCESS "A stage that touches a column it has not declared fails" ${skerry_check_access})
