// Reads contact problems from FCLIB files (fclib.h of the FCLIB library), which have one of two forms:
// - local: group fclib_local with spacedim, the matrix W, and the vectors q and mu,
// - global: group fclib_global with spacedim, the matrices M and H, and the vectors f, w and mu.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/problem/condense_problem.h"
#include "engine/problem/fclib_matrix.h"
#include "engine/problem/gather_blocks.h"
#include "skerry/problem.h"

namespace skerry {
namespace {

/// Combines scalar entries of W into 3 x 3 blocks, one BlockPart per block.
std::vector<BlockPart> blocks_of(std::vector<MatrixEntry> entries) {
    const auto place = [](const MatrixEntry& e) { return std::pair(e.row / 3, e.column / 3); };
    std::stable_sort(entries.begin(), entries.end(),
                     [&](const MatrixEntry& a, const MatrixEntry& b) { return place(a) < place(b); });
    std::vector<BlockPart> parts;
    for (const MatrixEntry& e : entries) {
        if (parts.empty() || std::pair(parts.back().row, parts.back().column) != place(e))
            parts.push_back({e.row / 3, e.column / 3, Mat3::Zero()});
        parts.back().value(e.row % 3, e.column % 3) += e.value;
    }
    return parts;
}

std::vector<Vec3> read_vectors3(const Hdf5File& file, const std::string& path, Index size, const char* size_meaning) {
    const std::vector<Real> value = file.reals(path);
    expect_size(file, path, value.size(), static_cast<std::size_t>(size), size_meaning);
    std::vector<Vec3> result;
    for (std::size_t i = 0; i < value.size(); i += 3) result.emplace_back(value[i], value[i + 1], value[i + 2]);
    return result;
}

std::vector<Real> read_friction(const Hdf5File& file, const std::string& path, Index contacts,
                                const char* size_meaning) {
    std::vector<Real> mu = file.reals(path);
    expect_size(file, path, mu.size(), static_cast<std::size_t>(contacts), size_meaning);
    const auto negative = std::find_if(mu.begin(), mu.end(), [](Real value) { return value < 0; });
    if (negative != mu.end()) file.complain(path, short_text(*negative), "friction coefficients >= 0");
    return mu;
}

void expect_three_dimensions(const Hdf5File& file, const std::string& root) {
    const Index dimension = file.integer(root + "/spacedim");
    if (dimension != 3) file.complain(root + "/spacedim", std::to_string(dimension), "3");
}

void read_local(const Hdf5File& file, ContactProblem& problem) {
    const std::string root = "/fclib_local";
    expect_three_dimensions(file, root);
    for (const char* part : {"/V", "/R"})
        if (file.has(root + part))
            file.complain(root + part, "equality constraints", "a problem without equality constraints",
                          "Skerry solves only contact constraints; remove the equality constraints");
    const auto [rows, columns] = read_matrix_size(file, root + "/W");
    if (rows < 3 || rows % 3 != 0) file.complain(root + "/W/m", std::to_string(rows), "a positive multiple of 3");
    if (columns != rows)
        file.complain(root + "/W/n", std::to_string(columns), std::to_string(rows) + ", because the matrix is square");
    MatrixEntries w = read_matrix(file, root + "/W");
    file.expect_group(root + "/vectors");
    problem.q = read_vectors3(file, root + "/vectors/q", rows, "rows of W");
    problem.mu = read_friction(file, root + "/vectors/mu", rows / 3, "one per contact, a third of the rows of W");
    problem.description = file.text_or_nothing(root + "/info/description");
    gather_blocks(blocks_of(std::move(w.entry)), problem);
}

void read_global(const Hdf5File& file, ContactProblem& problem) {
    const std::string root = "/fclib_global";
    expect_three_dimensions(file, root);
    if (file.has(root + "/G") && read_matrix_size(file, root + "/G").columns > 0)
        file.complain(root + "/G", "equality constraints", "a problem without equality constraints",
                      "Skerry solves only contact constraints; remove the equality constraints");
    const auto [rows, columns] = read_matrix_size(file, root + "/M");
    const auto [freedoms, relative] = read_matrix_size(file, root + "/H");
    if (rows < 1) file.complain(root + "/M/m", std::to_string(rows), "at least 1 degree of freedom");
    if (columns != rows)
        file.complain(root + "/M/n", std::to_string(columns), std::to_string(rows) + ", because the matrix is square");
    if (freedoms != rows) file.complain(root + "/H/m", std::to_string(freedoms), std::to_string(rows) + " (rows of M)");
    if (relative < 3 || relative % 3 != 0)
        file.complain(root + "/H/n", std::to_string(relative), "a positive multiple of 3");
    GlobalProblem global;
    global.mass = read_matrix(file, root + "/M");
    global.directions = read_matrix(file, root + "/H");
    file.expect_group(root + "/vectors");
    global.force = file.reals(root + "/vectors/f");
    expect_size(file, root + "/vectors/f", global.force.size(), static_cast<std::size_t>(rows), "rows of M");
    problem.q = read_vectors3(file, root + "/vectors/w", relative, "columns of H");
    problem.mu =
        read_friction(file, root + "/vectors/mu", relative / 3, "one per contact, a third of the columns of H");
    problem.description = file.text_or_nothing(root + "/info/description");
    if (const MassFault fault = condense_problem(global, problem); !fault.found.empty())
        file.complain(root + "/M", fault.found, fault.expected);
}

/// Throws SceneError unless W and q are finite. The numbers in the file are finite, but sums and products of large
/// numbers may overflow.
void expect_finite(const Hdf5File& file, const std::string& root, const ContactProblem& problem) {
    const auto finite = [](const auto& entries) {
        return std::all_of(entries.begin(), entries.end(), [](const auto& e) { return e.allFinite(); });
    };
    if (!finite(problem.block) || !finite(problem.q))
        file.complain(root + "/vectors", "numbers so large that W or q is not finite",
                      "numbers for which W and q are finite", "check the units of the numbers");
}

}  // namespace

ContactProblem read_problem(const std::filesystem::path& path) {
    const Hdf5File file(path, "an FCLIB problem (HDF5)");
    ContactProblem problem;
    problem.name = path.stem().string();
    if (!file.has("/fclib_local") && file.has("/fclib_global")) {
        file.expect_group("/fclib_global");
        read_global(file, problem);
        expect_finite(file, "/fclib_global", problem);
    } else {
        file.expect_group("/fclib_local",
                          "no FCLIB contact problem: the file has neither /fclib_local nor /fclib_global");
        read_local(file, problem);
        expect_finite(file, "/fclib_local", problem);
    }
    return problem;
}

}  // namespace skerry
