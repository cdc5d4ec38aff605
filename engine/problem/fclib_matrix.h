// The matrices of FCLIB (fclib.h of the FCLIB library, struct fclib_matrix), read into entries.
#pragma once

#include <string>
#include <vector>

#include "engine/hdf5/hdf5_file.h"

namespace skerry {

struct MatrixEntry {
    Index row, column;
    Real value;
};

/// Entries named twice add up.
struct MatrixEntries {
    Index rows = 0, columns = 0;
    std::vector<MatrixEntry> entry;
};

/// m and n of the matrix in a group.
struct MatrixSize {
    Index rows, columns;
};
MatrixSize read_matrix_size(const Hdf5File& file, const std::string& group);

/// All entries, in whichever storage the group has them: compressed columns (nz = -1), compressed rows (nz = -2), or nz
/// triplets. Throws SceneError.
MatrixEntries read_matrix(const Hdf5File& file, const std::string& group);

/// Complains unless `found` is `expected`, which `of` explains.
void expect_size(const Hdf5File& file, const std::string& path, std::size_t found, std::size_t expected,
                 const std::string& of);

}  // namespace skerry
