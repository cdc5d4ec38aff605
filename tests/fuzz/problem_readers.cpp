// Fuzz targets for FCLIB files, which are read, checked and solved for a few sweeps.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "engine/hdf5/hdf5_image.h"
#include "engine/problem/check_arrays.h"
#include "readers.h"
#include "skerry/problem.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

namespace {

const TemporaryFolder& folder() {
    static const TemporaryFolder made;
    return made;
}

void use_problem(const std::string& content) {
    const auto file = folder().write("problem.hdf5", content);
    try {
        const ContactProblem problem = read_problem(file);
        check_arrays(problem);
        for (const Mat3& block : problem.block) expect_valid(block.allFinite(), "an entry of W that is not finite");
        for (const Vec3& q : problem.q) expect_valid(q.allFinite(), "a velocity that is not finite");
        for (const Real mu : problem.mu) expect_valid(mu >= 0, "friction below zero");
        const ProblemSolution solution = solve_problem(problem, {.max_iterations = 20});
        if (!solution.converged) return;
        for (const Vec3& r : solution.reaction) expect_valid(r.allFinite(), "converged to what is not finite");
    } catch (const SceneError&) {
    }
}

/// The data sets of a problem, keyed by path.
struct ProblemValues {
    std::map<std::string, std::vector<Index>> integers;
    std::map<std::string, std::vector<Real>> reals;

    std::string hdf5() const {
        Hdf5Image image("problem.hdf5");
        for (const auto& [path, values] : integers) image.put(path, values);
        for (const auto& [path, values] : reals) image.put(path, values);
        const std::vector<char> bytes = image.bytes();
        return {bytes.begin(), bytes.end()};
    }
    void put_diagonal(const std::string& group, Index size) {
        std::vector<Index> begin, row;
        for (Index i = 0; i <= size; ++i) begin.push_back(i);
        for (Index i = 0; i < size; ++i) row.push_back(i);
        integers[group + "/m"] = integers[group + "/n"] = integers[group + "/nzmax"] = {size};
        integers[group + "/nz"] = {-1};
        integers[group + "/p"] = begin;
        integers[group + "/i"] = row;
        reals[group + "/x"] = std::vector<Real>(static_cast<std::size_t>(size), 2);
    }
};

ProblemValues local_values() {
    ProblemValues values;
    values.integers["/fclib_local/spacedim"] = {3};
    values.put_diagonal("/fclib_local/W", 6);
    values.reals["/fclib_local/vectors/q"] = {-1, 0.5, 0.1, -2, 0.3, -0.2};
    values.reals["/fclib_local/vectors/mu"] = {0.5, 0.3};
    return values;
}

ProblemValues global_values() {
    ProblemValues values;
    values.integers["/fclib_global/spacedim"] = {3};
    values.put_diagonal("/fclib_global/M", 6);
    values.put_diagonal("/fclib_global/H", 6);
    values.reals["/fclib_global/vectors/f"] = {-3, 1, 0.5, -8, 2, -1};
    values.reals["/fclib_global/vectors/w"] = {0, 0, 0.1, -0.2, 0, 0};
    values.reals["/fclib_global/vectors/mu"] = {0.5, 0.8};
    return values;
}

/// Makes one change of one data set. `code` selects the set, the kind of change, the entry and the value.
template <class T, std::size_t N>
void change(std::map<std::string, std::vector<T>>& sets, FileBytes code, const T (&telling)[N]) {
    const auto set = std::next(sets.begin(), static_cast<std::ptrdiff_t>(code[0] % sets.size()));
    std::vector<T>& values = set->second;
    const std::size_t at = values.empty() ? 0 : code[2] % values.size();
    switch (code[1] % 5) {
        case 0:
            values.resize(code[2] % 32, telling[code[3] % N]);
            return;
        case 1:
            values.insert(values.begin() + static_cast<std::ptrdiff_t>(at), telling[code[3] % N]);
            return;
        case 2:
            if (sets.size() > 1) sets.erase(set);
            return;
        case 3:
            if (!values.empty()) values[at] = telling[code[3] % N];
            return;
        default:
            if (!values.empty()) values[at] = static_cast<T>(static_cast<std::int8_t>(code[3]));
    }
}

}  // namespace

void read_problem_bytes(FileBytes bytes) {
    use_problem({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void read_problem_values_bytes(FileBytes bytes) {
    if (bytes.empty()) return;
    ProblemValues values = bytes[0] % 2 == 0 ? local_values() : global_values();
    constexpr Real big = std::numeric_limits<Real>::max(), none = std::numeric_limits<Real>::quiet_NaN();
    constexpr Real reals[] = {0,    -0.0, 1,     -1, 1e-300, 1e300, big, none, std::numeric_limits<Real>::infinity(),
                              1e-8, 1e8,  5e-324};
    constexpr Index integers[] = {0, 1, -1, -2, 2, 3, 6, 7, 9, 2147483647, -2147483647 - 1, 1 << 30, 65536};
    for (FileBytes rest = bytes.subspan(1); rest.size() >= 4; rest = rest.subspan(4)) {
        if (rest[0] % 2 == 0)
            change(values.integers, rest, integers);
        else
            change(values.reals, rest, reals);
    }
    use_problem(values.hdf5());
}

std::vector<std::string> sample_problems() {
    return {local_values().hdf5(), global_values().hdf5()};
}

}  // namespace skerry::test
