#include "engine/problem/fclib_matrix.h"

#include <algorithm>

namespace skerry {
namespace {

void expect_index(const Hdf5File& file, const std::string& path, Index index, Index size) {
    if (index < 0 || index >= size)
        file.complain(path, "index " + std::to_string(index), "0 to " + std::to_string(size - 1));
}

/// Reads a matrix stored by compressed columns (nz = -1) or compressed rows (nz = -2). Array p contains the offset of
/// each column (row), array i the row (column) index of each entry.
void read_compressed(const Hdf5File& file, const std::string& group, bool by_rows, MatrixEntries& matrix) {
    const Index lines = by_rows ? matrix.rows : matrix.columns, places = by_rows ? matrix.columns : matrix.rows;
    const std::vector<Index> begin = file.integers(group + "/p"), place = file.integers(group + "/i");
    const std::vector<Real> value = file.reals(group + "/x");
    const Index nzmax = file.integer(group + "/nzmax");
    if (nzmax < 0) file.complain(group + "/nzmax", std::to_string(nzmax), "a number >= 0");
    expect_size(file, group + "/p", begin.size(), static_cast<std::size_t>(lines) + 1,
                by_rows ? "rows + 1" : "columns + 1");
    expect_size(file, group + "/i", place.size(), static_cast<std::size_t>(nzmax), "nzmax");
    expect_size(file, group + "/x", value.size(), static_cast<std::size_t>(nzmax), "nzmax");
    file.expect_offsets(group + "/p", begin, static_cast<std::size_t>(nzmax));
    matrix.entry.reserve(value.size());
    for (Index line = 0; line < lines; ++line)
        for (Index k = begin[line]; k < begin[line + 1]; ++k) {
            expect_index(file, group + "/i", place[k], places);
            matrix.entry.push_back(by_rows ? MatrixEntry{line, place[k], value[k]}
                                           : MatrixEntry{place[k], line, value[k]});
        }
}

/// Reads a matrix stored as nz triplets. Array p contains columns and array i rows, as in CSparse, whose arrays Siconos
/// writes. (Comments in fclib.h state the opposite; for the symmetric matrices W and M there is no difference.)
void read_triplets(const Hdf5File& file, const std::string& group, Index nz, MatrixEntries& matrix) {
    const std::vector<Index> column = file.integers(group + "/p"), row = file.integers(group + "/i");
    const std::vector<Real> value = file.reals(group + "/x");
    const std::size_t count = static_cast<std::size_t>(nz);
    for (const auto& [field, found] : {std::pair{"/p", column.size()}, {"/i", row.size()}, {"/x", value.size()}})
        if (found < count)
            file.complain(group + field, std::to_string(found) + " values",
                          "at least " + std::to_string(count) + " (nz)");
    matrix.entry.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        expect_index(file, group + "/i", row[k], matrix.rows);
        expect_index(file, group + "/p", column[k], matrix.columns);
        matrix.entry.push_back({row[k], column[k], value[k]});
    }
}

}  // namespace

void expect_size(const Hdf5File& file, const std::string& path, std::size_t found, std::size_t expected,
                 const std::string& meaning) {
    if (found != expected)
        file.complain(path, std::to_string(found) + " values", std::to_string(expected) + " (" + meaning + ")");
}

MatrixSize read_matrix_size(const Hdf5File& file, const std::string& group) {
    file.expect_group(group);
    const MatrixSize size{file.integer(group + "/m"), file.integer(group + "/n")};
    if (size.rows < 0) file.complain(group + "/m", std::to_string(size.rows), "a number of rows >= 0");
    if (size.columns < 0) file.complain(group + "/n", std::to_string(size.columns), "a number of columns >= 0");
    return size;
}

MatrixEntries read_matrix(const Hdf5File& file, const std::string& group) {
    const MatrixSize size = read_matrix_size(file, group);
    const Index nz = file.integer(group + "/nz");
    if (nz < -2)
        file.complain(group + "/nz", std::to_string(nz),
                      "-1 (compressed columns), -2 (compressed rows) or a number of triplets >= 0");
    MatrixEntries matrix{size.rows, size.columns, {}};
    if (nz >= 0)
        read_triplets(file, group, nz, matrix);
    else
        read_compressed(file, group, nz == -2, matrix);
    return matrix;
}

}  // namespace skerry
