# One message names all missing packages.
set(skerry_missing "")

# skerry_need(PACKAGE VERSION DEBIAN [option of find_package...]): DEBIAN is the name of the Debian package.
macro(skerry_need package version debian)
    find_package(${package} ${version} QUIET ${ARGN})
    if(NOT ${package}_FOUND)
        string(APPEND skerry_missing "\n    ${package} ${version} (Debian: ${debian})")
    endif()
endmacro()

skerry_need(Eigen3 3.4 libeigen3-dev NO_MODULE)
find_package(Threads REQUIRED)
if("openmp" IN_LIST SKERRY_BACKENDS)
    skerry_need(OpenMP 4.5 g++ COMPONENTS CXX)
endif()
if("tbb" IN_LIST SKERRY_BACKENDS)
    skerry_need(TBB 2021 libtbb-dev)
endif()
if(SKERRY_HDF5)
    skerry_need(HDF5 1.8 libhdf5-dev COMPONENTS C)
endif()
if(SKERRY_PAGES)
    skerry_need(ZLIB 1.2 zlib1g-dev)
endif()
if(SKERRY_SCENES OR SKERRY_PAGES)
    skerry_need(nlohmann_json 3.9 nlohmann-json3-dev)
endif()
set(skerry_whole "")  # parts of the build that need the complete library
foreach(part IN ITEMS PROGRAM TESTS PROFILING)
    if(SKERRY_${part})
        list(APPEND skerry_whole SKERRY_${part})
    endif()
endforeach()
if(skerry_whole)
    skerry_need(CLI11 2.1 libcli11-dev)
    foreach(part IN ITEMS HDF5 SCENES PAGES)
        if(NOT SKERRY_${part})
            list(JOIN skerry_whole ", " skerry_whole)
            message(FATAL_ERROR "SKERRY_${part} is OFF: found ${skerry_whole} on, expected them off as well")
        endif()
    endforeach()
endif()
# xxHash is compiled into the library, so hosts do not need it.
find_path(XXHASH_INCLUDE xxhash.h DOC "Folder of xxhash.h (0.8 or later; Debian: libxxhash-dev)")
mark_as_advanced(XXHASH_INCLUDE)
if(NOT XXHASH_INCLUDE)
    string(APPEND skerry_missing "\n    xxhash 0.8 (Debian: libxxhash-dev)")
endif()

# three.js is part of the library, so an installed library needs no data files.
if(SKERRY_PAGES)
    find_file(SKERRY_THREE_JS three.min.js PATHS /usr/share/javascript/three /usr/share/nodejs/three/build
        NO_DEFAULT_PATH DOC "three.min.js (r111 or near; Debian: libjs-three) that PageWriter inlines")
    if(NOT SKERRY_THREE_JS AND SKBUILD)  # a wheel must be complete
        string(APPEND skerry_missing "\n    three.min.js r111 (Debian: libjs-three); set SKERRY_THREE_JS to its path")
    endif()
endif()

if(skerry_missing)
    message(FATAL_ERROR "Packages that Skerry needs were not found:${skerry_missing}\n"
        "Install them, with apt-get or another package manager, or name their folder in CMAKE_PREFIX_PATH. "
        "SKERRY_HDF5=OFF, SKERRY_SCENES=OFF, SKERRY_PAGES=OFF and SKERRY_BACKENDS=threads need fewer of them.\n")
endif()
if(SKERRY_PYTHON)
    find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module ${SKBUILD_SABI_COMPONENT})
    execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir
        OUTPUT_VARIABLE nanobind_DIR OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE missing)
    if(missing)
        message(FATAL_ERROR "SKERRY_PYTHON is ON: ${Python_EXECUTABLE} has no package nanobind; expected one "
                            "(pip install nanobind), or Python_EXECUTABLE naming a Python that has it")
    endif()
    find_package(nanobind 3 CONFIG REQUIRED)
endif()
