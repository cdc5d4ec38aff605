find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)  # also for omp simd in the kernels
if("tbb" IN_LIST SKERRY_BACKENDS)
    find_package(TBB 2021 REQUIRED)
endif()
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(ZLIB REQUIRED)
find_package(nlohmann_json 3.9 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
# Compiled in: nothing of it is needed where the library is used.
find_path(XXHASH_INCLUDE xxhash.h REQUIRED DOC "Folder of xxhash.h (0.8 or later; Debian: libxxhash-dev)")
mark_as_advanced(XXHASH_INCLUDE)
