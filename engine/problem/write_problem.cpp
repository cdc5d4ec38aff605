// Writes a contact problem in the local form of FCLIB. The data sets have the order and the types that FCLIB's own
// writer gives them.
#include <ostream>
#include <string>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/hdf5/hdf5_image.h"
#include "engine/problem/check_arrays.h"
#include "skerry/problem.h"

namespace skerry {
namespace {

/// The nonzero entries of W as compressed columns (nz = -1), with ascending row indices in each column.
struct CompressedColumns {
    std::vector<Index> begin, row;
    std::vector<Real> value;
};

CompressedColumns compress(const ContactProblem& problem) {
    const std::size_t contacts = problem.q.size();
    CompressedColumns w;
    w.begin.assign(3 * contacts + 1, 0);
    // The block rows are visited in order, so the entries of every column are visited by ascending row. A first pass
    // counts the entries, a second pass stores them.
    const auto for_each_entry = [&](auto&& visit) {
        for (std::size_t i = 0; i < contacts; ++i)
            for (int a = 0; a < 3; ++a)
                for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
                    for (int b = 0; b < 3; ++b)
                        if (const Real value = problem.block[k](a, b); value != 0)
                            visit(static_cast<Index>(3 * i) + a, static_cast<std::size_t>(3 * problem.column[k] + b),
                                  value);
    };
    for_each_entry([&](Index, std::size_t column, Real) { ++w.begin[column + 1]; });
    for (std::size_t c = 0; c < 3 * contacts; ++c) w.begin[c + 1] += w.begin[c];
    w.row.resize(static_cast<std::size_t>(w.begin.back()));
    w.value.resize(w.row.size());
    std::vector<Index> next(w.begin.begin(), w.begin.end() - 1);
    for_each_entry([&](Index row, std::size_t column, Real value) {
        w.row[next[column]] = row;
        w.value[next[column]++] = value;
    });
    return w;
}

std::span<const Real> flat(std::span<const Vec3> vectors) {
    static_assert(sizeof(Vec3) == 3 * sizeof(Real));
    return {vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size()};
}

void put_matrix(const ContactProblem& problem, Hdf5Image& image) {
    const CompressedColumns w = compress(problem);
    const Index rows = 3 * problem.contacts();
    image.put("/fclib_local/W/nzmax", w.begin.back());
    image.put("/fclib_local/W/m", rows);
    image.put("/fclib_local/W/n", rows);
    image.put("/fclib_local/W/nz", -1);
    image.put("/fclib_local/W/p", w.begin);
    image.put("/fclib_local/W/i", w.row);
    image.put("/fclib_local/W/x", w.value);
}

void put_solution(const ContactProblem& problem, std::span<const Vec3> reaction, Hdf5Image& image) {
    std::vector<Vec3> velocity = problem.q;
    for (std::size_t i = 0; i < velocity.size(); ++i)
        for (Index k = problem.row_offset[i]; k < problem.row_offset[i + 1]; ++k)
            velocity[i] += problem.block[k] * reaction[problem.column[k]];
    image.put("/solution/u", flat(velocity));
    image.put("/solution/r", flat(reaction));
}

}  // namespace

void write_problem(const ContactProblem& problem, const std::filesystem::path& file, std::span<const Vec3> reaction) {
    check_arrays(problem);
    const std::string name = file.string(), title = title_of(problem);
    if (problem.q.empty()) refuse_in(name, title, "q", "no contacts", "at least one contact");
    if (!reaction.empty() && reaction.size() != problem.q.size())
        refuse_in(name, title, "reaction", std::to_string(reaction.size()) + " values",
                  std::to_string(problem.q.size()) + ", one per contact");
    Hdf5Image image(name);
    image.put("/fclib_local/spacedim", 3);
    put_matrix(problem, image);
    image.put("/fclib_local/vectors/q", flat(problem.q));
    image.put("/fclib_local/vectors/mu", problem.mu);
    image.put_text("/fclib_local/info/title", problem.name);
    image.put_text("/fclib_local/info/description", problem.description);
    image.put_text(
        "/fclib_local/info/math_info",
        "u = W r + q; by contact: normal, tangent 1, tangent 2; u in m/s, r in N s, W in 1/kg; Coulomb's law");
    if (!reaction.empty()) put_solution(problem, reaction, image);
    const std::vector<char> bytes = image.bytes();
    write_file(file, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

}  // namespace skerry
