// Reads matrices of an FCLIB file (fclib.h of the FCLIB library, struct fclib_matrix) as lists of entries.
#pragma once

#include <string>
#include <vector>

#include "engine/hdf5/hdf5_file.h"

namespace skerry {

struct MatrixEntry {
    Index row, column;
    Real value;
};

/// A sparse matrix as a list of entries. Entries at the same position are summed.
struct MatrixEntries {
    Index rows = 0, columns = 0;
    std::vector<MatrixEntry> entry;
};

/// Size m x n of a matrix stored in an HDF5 group.
struct MatrixSize {
    Index rows, columns;
};
MatrixSize read_matrix_size(const Hdf5File& file, const std::string& group);

/// Reads all entries of a matrix. Its field nz says how they are stored: -1 for compressed columns, -2 for compressed
/// rows, otherwise the number of triplets (row, column, value). Throws SceneError.
MatrixEntries read_matrix(const Hdf5File& file, const std::string& group);

/// Throws SceneError unless the number `found` equals the number `expected`. `meaning` explains the expected number in
/// the message, for example "rows of W".
void expect_size(const Hdf5File& file, const std::string& path, std::size_t found, std::size_t expected,
                 const std::string& meaning);

}  // namespace skerry
