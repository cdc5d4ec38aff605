// The local form of FCLIB (fclib.h of the FCLIB library): group fclib_local with spacedim, the matrix W, and the vectors q and mu.
#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "engine/problem/hdf5_file.h"
#include "skerry/problem.h"

namespace skerry {
namespace {

const std::string root = "/fclib_local";

struct Entry {
    Index row, column;
    Real value;
};

std::string number(std::size_t value) {
    return std::to_string(value);
}

void expect_size(const Hdf5File& file, const std::string& path, std::size_t found, std::size_t expected, const std::string& of) {
    if (found != expected) file.complain(path, number(found) + " values", number(expected) + " (" + of + ")");
}

void expect_index(const Hdf5File& file, const std::string& path, Index index, Index size) {
    if (index < 0 || index >= size) file.complain(path, "index " + std::to_string(index), "0 to " + std::to_string(size - 1));
}

/// Compressed columns (FCLIB writes nz = -1) or rows (nz = -2).
std::vector<Entry> read_compressed(const Hdf5File& file, Index size, bool by_rows) {
    const std::vector<Index> begin = file.integers(root + "/W/p"), other = file.integers(root + "/W/i");
    const std::vector<Real> value = file.reals(root + "/W/x");
    const Index nzmax = file.integer(root + "/W/nzmax");
    if (nzmax < 0) file.complain(root + "/W/nzmax", std::to_string(nzmax), "a size");
    expect_size(file, root + "/W/p", begin.size(), static_cast<std::size_t>(size) + 1, by_rows ? "rows + 1" : "columns + 1");
    expect_size(file, root + "/W/i", other.size(), static_cast<std::size_t>(nzmax), "nzmax");
    expect_size(file, root + "/W/x", value.size(), static_cast<std::size_t>(nzmax), "nzmax");
    if (begin.front() != 0 || begin.back() > nzmax || !std::is_sorted(begin.begin(), begin.end()))
        file.complain(root + "/W/p", "offsets that do not ascend from 0 to at most nzmax", "offsets in ascending order");
    std::vector<Entry> entries;
    entries.reserve(value.size());
    for (Index line = 0; line < size; ++line)
        for (Index k = begin[line]; k < begin[line + 1]; ++k) {
            expect_index(file, root + "/W/i", other[k], size);
            entries.push_back(by_rows ? Entry{line, other[k], value[k]} : Entry{other[k], line, value[k]});
        }
    return entries;
}

/// Triplets: nz of them, p columns and i rows; entries named twice add up.
std::vector<Entry> read_triplets(const Hdf5File& file, Index size, Index nz) {
    const std::vector<Index> column = file.integers(root + "/W/p"), row = file.integers(root + "/W/i");
    const std::vector<Real> value = file.reals(root + "/W/x");
    const std::size_t count = static_cast<std::size_t>(nz);
    for (const auto& [field, found] : {std::pair{"/W/p", column.size()}, {"/W/i", row.size()}, {"/W/x", value.size()}})
        if (found < count) file.complain(root + field, number(found) + " values", "at least " + number(count) + " (nz)");
    std::vector<Entry> entries;
    entries.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
        expect_index(file, root + "/W/i", row[k], size);
        expect_index(file, root + "/W/p", column[k], size);
        entries.push_back({row[k], column[k], value[k]});
    }
    return entries;
}

std::vector<Entry> read_matrix(const Hdf5File& file, Index& size) {
    file.expect_group(root + "/W");
    const Index rows = file.integer(root + "/W/m"), columns = file.integer(root + "/W/n"), nz = file.integer(root + "/W/nz");
    if (rows < 3 || rows % 3 != 0) file.complain(root + "/W/m", std::to_string(rows), "a positive multiple of 3");
    if (columns != rows) file.complain(root + "/W/n", std::to_string(columns), std::to_string(rows) + " (square, as m)");
    if (nz < -2) file.complain(root + "/W/nz", std::to_string(nz), "-1 (columns), -2 (rows) or the number of triplets");
    size = rows;
    return nz >= 0 ? read_triplets(file, size, nz) : read_compressed(file, size, nz == -2);
}

/// Gathers entries into blocks, row by row. Blocks of zeros couple nothing and are left out, except on the diagonal.
void gather_blocks(std::vector<Entry> entries, ContactProblem& problem) {
    const Index contacts = problem.contacts();
    for (Index i = 0; i < contacts; ++i) entries.push_back({3 * i, 3 * i, 0});
    const auto place = [](const Entry& e) { return std::pair(e.row / 3, e.column / 3); };
    std::stable_sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
    problem.row_offset.assign(static_cast<std::size_t>(contacts) + 1, 0);
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        const auto [row, column] = place(entries[begin]);
        Mat3 block = Mat3::Zero();
        for (; end < entries.size() && place(entries[end]) == std::pair(row, column); ++end)
            block(entries[end].row % 3, entries[end].column % 3) += entries[end].value;
        if (row != column && block.isZero(0)) continue;
        problem.column.push_back(column);
        problem.block.push_back(block);
        ++problem.row_offset[row + 1];
    }
    std::partial_sum(problem.row_offset.begin(), problem.row_offset.end(), problem.row_offset.begin());
}

void read_vectors(const Hdf5File& file, Index size, ContactProblem& problem) {
    file.expect_group(root + "/vectors");
    const std::vector<Real> q = file.reals(root + "/vectors/q");
    expect_size(file, root + "/vectors/q", q.size(), static_cast<std::size_t>(size), "rows of W");
    problem.mu = file.reals(root + "/vectors/mu");
    expect_size(file, root + "/vectors/mu", problem.mu.size(), static_cast<std::size_t>(size / 3), "contacts, a third of the rows of W");
    const auto negative = std::find_if(problem.mu.begin(), problem.mu.end(), [](Real mu) { return mu < 0; });
    if (negative != problem.mu.end()) file.complain(root + "/vectors/mu", std::to_string(*negative), "friction coefficients >= 0");
    for (std::size_t i = 0; i < q.size(); i += 3) problem.q.emplace_back(q[i], q[i + 1], q[i + 2]);
}

}  // namespace

ContactProblem read_problem(const std::filesystem::path& path) {
    const Hdf5File file(path);
    const bool global = file.has("/fclib_global");
    file.expect_group(root, global ? "the file holds a global problem; condense it to its contacts first" : "");
    const Index dimension = file.integer(root + "/spacedim");
    if (dimension != 3) file.complain(root + "/spacedim", std::to_string(dimension), "3");
    for (const char* part : {"/V", "/R"})
        if (file.has(root + part))
            file.complain(root + part, "equality constraints", "contacts alone",
                          "local problems with equality constraints are not solved here");
    ContactProblem problem;
    problem.name = path.stem().string();
    Index size = 0;
    std::vector<Entry> entries = read_matrix(file, size);
    read_vectors(file, size, problem);
    gather_blocks(std::move(entries), problem);
    return problem;
}

}  // namespace skerry
