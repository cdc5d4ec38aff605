#include "skerry/problem.h"

#include <hdf5.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "skerry/error.h"

using namespace skerry;
namespace fs = std::filesystem;

namespace {

/// What a file says, so that one thing can be spoilt at a time.
struct FclibFile {
    std::vector<int> spacedim{3}, m{6}, n{6}, nz{-1}, nzmax{20};
    std::vector<int> p{0, 4, 8, 11, 14, 17, 20};
    std::vector<int> i{0, 1, 3, 4, 0, 1, 3, 4, 2, 3, 5, 0, 2, 3, 1, 4, 5, 2, 4, 5};
    std::vector<double> x, q{-1, 0.5, 0.1, -2, 0.3, -0.2}, mu{0.5, 0.3};
    bool with_v = false, real_p = false;
    std::string root = "fclib_local";
    std::string left_out;  // a data set or group that is not written

    FclibFile() {
        for (std::size_t k = 0; k < i.size(); ++k) x.push_back(0.01 * static_cast<double>(k + 1));
        for (int column = 0; column < 6; ++column)
            for (int k = p[static_cast<std::size_t>(column)]; k < p[static_cast<std::size_t>(column) + 1]; ++k)
                if (i[static_cast<std::size_t>(k)] == column) x[static_cast<std::size_t>(k)] = 2;
    }
    template <class T>
    void put(hid_t group, const char* name, const std::vector<T>& values) const {
        if (left_out == name) return;
        const bool whole = std::is_same_v<T, int>;
        const hsize_t size = values.size();
        const hid_t space = H5Screate_simple(1, &size, nullptr), type = whole ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
        const hid_t data = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        if (size > 0) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Dclose(data);
        H5Sclose(space);
    }
    void in_group(hid_t parent, const char* name, const std::function<void(hid_t)>& fill) const {
        if (left_out == name) return;
        const hid_t group = H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        fill(group);
        H5Gclose(group);
    }
    fs::path write() const {
        const fs::path path = fs::temp_directory_path() / ("skerry_problem_test_" + std::to_string(std::random_device{}()) + ".hdf5");
        const hid_t file = H5Fcreate(path.string().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
        in_group(file, root.c_str(), [&](hid_t local) {
            put(local, "spacedim", spacedim);
            in_group(local, "W", [&](hid_t w) {
                put(w, "m", m);
                put(w, "n", n);
                put(w, "nz", nz);
                put(w, "nzmax", nzmax);
                if (real_p) {
                    put(w, "p", std::vector<double>(p.begin(), p.end()));
                } else {
                    put(w, "p", p);
                }
                put(w, "i", i);
                put(w, "x", x);
            });
            if (with_v) in_group(local, "V", [](hid_t) {});
            in_group(local, "vectors", [&](hid_t vectors) {
                put(vectors, "q", q);
                put(vectors, "mu", mu);
            });
        });
        H5Fclose(file);
        return path;
    }
};

ContactProblem read_back(const FclibFile& file) {
    const fs::path path = file.write();
    const ContactProblem problem = read_problem(path);
    fs::remove(path);
    return problem;
}

std::string refusal_of(const fs::path& path) {
    try {
        read_problem(path);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "read";
}

std::string refusal(const FclibFile& file) {
    const fs::path path = file.write();
    const std::string text = refusal_of(path);
    fs::remove(path);
    CHECK(text.find(path.filename().string()) != std::string::npos);
    return text;
}

Real entry(const ContactProblem& problem, int row, int column) {
    for (Index k = problem.row_offset[static_cast<std::size_t>(row / 3)]; k < problem.row_offset[static_cast<std::size_t>(row / 3) + 1];
         ++k)
        if (problem.column[static_cast<std::size_t>(k)] == column / 3)
            return problem.block[static_cast<std::size_t>(k)](row % 3, column % 3);
    return 0;
}

/// |e| / max(|q|, |r|, |u|), written down once more from peers.md, sharing no code with the library.
Real independent_error(const ContactProblem& problem, const std::vector<Vec3>& reaction) {
    Real lack = 0, q2 = 0, r2 = 0, u2 = 0;
    for (std::size_t c = 0; c < problem.q.size(); ++c) {
        Vec3 u = problem.q[c];
        for (Index k = problem.row_offset[c]; k < problem.row_offset[c + 1]; ++k)
            u += problem.block[static_cast<std::size_t>(k)] *
                 reaction[static_cast<std::size_t>(problem.column[static_cast<std::size_t>(k)])];
        const Real mu = problem.mu[c];
        const Vec3 r = reaction[c];
        const Vec3 x = r - Vec3(u[0] + mu * std::sqrt(u[1] * u[1] + u[2] * u[2]), u[1], u[2]);
        const Real t = std::sqrt(x[1] * x[1] + x[2] * x[2]);
        Vec3 projected = x;
        if (mu * t <= -x[0]) {
            projected = Vec3::Zero();
        } else if (t > mu * x[0]) {
            projected[0] = (x[0] + mu * t) / (1 + mu * mu);
            projected[1] = mu * projected[0] * x[1] / t;
            projected[2] = mu * projected[0] * x[2] / t;
        }
        lack += (r - projected).squaredNorm();
        q2 += problem.q[c].squaredNorm();
        r2 += r.squaredNorm();
        u2 += u.squaredNorm();
    }
    return std::sqrt(lack) / std::sqrt(std::max({q2, r2, u2}));
}

/// The folder of problems from elsewhere, if this machine has one.
fs::path shared_problems() {
    const char* variable = std::getenv("SKERRY_SHARED_DATA");
    const fs::path data = variable ? fs::path(variable) : fs::path(SKERRY_SOURCE_DIR) / ".." / "shared" / "data";
    return data / "friction_problems";
}

}  // namespace

TEST_CASE("a written problem reads back entry by entry", "[unit][problem]") {
    const FclibFile file;
    const ContactProblem problem = read_back(file);
    REQUIRE(problem.contacts() == 2);
    CHECK(problem.mu == file.mu);
    CHECK(problem.q[1] == Vec3(-2, 0.3, -0.2));
    for (int column = 0; column < 6; ++column) {
        std::vector<double> expected(6, 0);
        for (int k = file.p[static_cast<std::size_t>(column)]; k < file.p[static_cast<std::size_t>(column) + 1]; ++k)
            expected[static_cast<std::size_t>(file.i[static_cast<std::size_t>(k)])] += file.x[static_cast<std::size_t>(k)];
        for (int row = 0; row < 6; ++row) CHECK(entry(problem, row, column) == expected[static_cast<std::size_t>(row)]);
    }
}

TEST_CASE("rows and triplets are read like columns", "[unit][problem]") {
    const ContactProblem by_columns = read_back({});
    FclibFile rows;
    rows.nz = {-2};
    const ContactProblem by_rows = read_back(rows);
    FclibFile triplets;
    triplets.nz = {20};
    std::vector<int> column;
    for (int c = 0; c < 6; ++c)
        for (int k = triplets.p[static_cast<std::size_t>(c)]; k < triplets.p[static_cast<std::size_t>(c) + 1]; ++k) column.push_back(c);
    triplets.p = column;
    const ContactProblem by_triplets = read_back(triplets);
    for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c) {
            CHECK(entry(by_rows, r, c) == entry(by_columns, c, r));
            CHECK(entry(by_triplets, r, c) == entry(by_columns, r, c));
        }
}

TEST_CASE("every malformed file is refused by name of what is wrong", "[unit][problem]") {
    const auto spoil = [](const std::function<void(FclibFile&)>& change) {
        FclibFile file;
        change(file);
        return refusal(file);
    };
    const auto says = [](const std::string& text, std::initializer_list<const char*> words) {
        for (const char* word : words) {
            INFO(text);
            CHECK(text.find(word) != std::string::npos);
        }
    };
    says(spoil([](auto& f) { f.spacedim = {2}; }), {"fclib_local", "spacedim", "2", "expected 3"});
    says(spoil([](auto& f) { f.spacedim = {3, 3}; }), {"spacedim", "2 values", "one integer"});
    for (const char* name : {"W", "vectors", "spacedim", "m", "n", "nz", "nzmax", "p", "i", "x", "q", "mu"})
        says(spoil([&](auto& f) { f.left_out = name; }), {name, "nothing"});
    says(spoil([](auto& f) { f.root = "something"; }), {"fclib_local", "nothing", "a group"});
    says(spoil([](auto& f) { f.root = "fclib_global"; }), {"fclib_local", "global"});
    says(spoil([](auto& f) { f.with_v = true; }), {"V", "equality constraints"});
    says(spoil([](auto& f) { f.m = f.n = {7}; }), {"W", "m", "7", "multiple of 3"});
    says(spoil([](auto& f) { f.m = {0}; }), {"W", "m", "0"});
    says(spoil([](auto& f) { f.n = {9}; }), {"n", "9", "6"});
    says(spoil([](auto& f) { f.nz = {-3}; }), {"nz", "-3"});
    says(spoil([](auto& f) { f.p.pop_back(); }), {"W", "p", "6 values", "7"});
    says(spoil([](auto& f) { f.i.pop_back(); }), {"i", "19 values", "20"});
    says(spoil([](auto& f) { f.x.pop_back(); }), {"x", "19 values", "20"});
    says(spoil([](auto& f) { std::swap(f.p[1], f.p[2]); }), {"p", "ascend"});
    says(spoil([](auto& f) { f.p.back() = 21; }), {"p", "nzmax"});
    says(spoil([](auto& f) { f.i[3] = 6; }), {"i", "index 6", "0 to 5"});
    says(spoil([](auto& f) { f.i[3] = -1; }), {"i", "index -1"});
    says(spoil([](auto& f) { f.nz = {30}; }), {"W", "p", "7 values", "30"});
    says(spoil([](auto& f) { f.real_p = true; }), {"p", "another type", "integers"});
    says(spoil([](auto& f) { f.q.pop_back(); }), {"vectors", "q", "5 values", "6"});
    says(spoil([](auto& f) { f.mu.push_back(1); }), {"mu", "3 values", "2"});
    says(spoil([](auto& f) { f.mu[1] = -0.1; }), {"mu", "-0.1", ">= 0"});
    says(spoil([](auto& f) { f.q[2] = std::numeric_limits<double>::quiet_NaN(); }), {"q", "nan", "entry 2", "finite"});
    says(spoil([](auto& f) { f.x[4] = std::numeric_limits<double>::infinity(); }), {"x", "inf", "entry 4", "finite"});
    says(spoil([](auto& f) { f.mu[0] = std::numeric_limits<double>::quiet_NaN(); }), {"mu", "nan"});
}

TEST_CASE("a file that is missing, a folder, or not HDF5 is refused", "[unit][problem]") {
    CHECK(refusal_of("/no/such/file.hdf5").find("no such file") != std::string::npos);
    CHECK(refusal_of(fs::temp_directory_path()).find("directory") != std::string::npos);
    const fs::path text = fs::temp_directory_path() / ("skerry_problem_test_" + std::to_string(std::random_device{}()) + ".txt");
    std::ofstream(text) << "not HDF5";
    CHECK(refusal_of(text).find("not HDF5") != std::string::npos);
    fs::remove(text);
    const fs::path whole = FclibFile{}.write();
    fs::resize_file(whole, fs::file_size(whole) / 2);  // a download that broke off
    CHECK(refusal_of(whole) != "read");
    fs::remove(whole);
}

TEST_CASE("a problem of two contacts is solved with both methods and laws", "[unit][problem]") {
    const ContactProblem problem = read_back({});
    for (const SolverMethod method : {SolverMethod::pgs, SolverMethod::pcg_pgs})
        for (const Friction friction : {Friction::cone, Friction::pyramid}) {
            const ProblemSolution solution = solve_problem(problem, {.method = method, .friction = friction, .tolerance = 1e-10});
            CHECK(solution.converged);
            CHECK(solution.error <= 1e-10);
            CHECK(solution.regions == 1);
            CHECK(solution.seconds > 0);
            if (friction == Friction::cone) CHECK(independent_error(problem, solution.reaction) <= 1.01e-10);
        }
}

TEST_CASE("contacts without a common block are regions of their own", "[unit][problem]") {
    ContactProblem problem;
    problem.row_offset = {0, 1, 2, 3};
    problem.column = {0, 1, 2};
    problem.block.assign(3, 2 * Mat3::Identity());
    problem.q = {{-1, 0, 0}, {1, 0, 0}, {-2, 8, 0}};
    problem.mu = {0.5, 0.5, 0.5};
    const ProblemSolution solution = solve_problem(problem, {});
    CHECK(solution.regions == 3);
    CHECK(solution.converged);
    CHECK((solution.reaction[0] - Vec3(0.5, 0, 0)).norm() < 1e-15);
    CHECK(solution.reaction[1] == Vec3::Zero());
    CHECK((solution.reaction[2] - Vec3(1, -0.5, 0)).norm() < 1e-14);
    problem.mu.pop_back();
    CHECK_THROWS_AS(solve_problem(problem, {}), SceneError);
}

TEST_CASE("an empty problem is solved", "[unit][problem]") {
    ContactProblem problem;
    problem.row_offset = {0};
    const ProblemSolution solution = solve_problem(problem, {});
    CHECK(solution.converged);
    CHECK(solution.regions == 0);
}

TEST_CASE("a problem that cannot be solved within the limit says so", "[unit][problem]") {
    const ProblemSolution solution = solve_problem(read_back({}), {.tolerance = 0, .max_iterations = 3});
    CHECK_FALSE(solution.converged);
    CHECK(solution.iterations == 3);
}

TEST_CASE("the error is that of FCLIB", "[unit][problem]") {
    const ContactProblem problem = read_back({});
    const std::vector<Vec3> guess{{0.3, 0.1, -0.2}, {0.9, -0.3, 0.1}};
    const ProblemError error = problem_error(problem, guess);
    CHECK(error.relative == Approx(independent_error(problem, guess)).epsilon(1e-13));
    CHECK(error.absolute / error.over_q == Approx(std::sqrt(1 + 0.25 + 0.01 + 4 + 0.09 + 0.04)).epsilon(1e-13));
    CHECK_THROWS_AS(problem_error(problem, std::vector<Vec3>(1)), SceneError);
}

TEST_CASE("all problems of the shared data load, and all but one are solved to 1e-6", "[unit][problem][slow]") {
    const fs::path folder = shared_problems();
    if (!fs::is_directory(folder)) {
        WARN("no folder " << folder << ": set SKERRY_SHARED_DATA");
        return;
    }
    int count = 0;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
        if (file.path().extension() != ".hdf5") continue;
        ++count;
        const ContactProblem problem = read_problem(file.path());
        // Gauss-Seidel stagnates at 8e-5 there; so-bogus, also Gauss-Seidel, does not reach 1e-6 either
        const bool hard = problem.name.starts_with("OneObject");
        const Real tolerance = hard ? 1e-3 : 1e-6;
        const ProblemSolution solution = solve_problem(problem, {.tolerance = tolerance});
        INFO(problem.name << " " << solution.error);
        CHECK(solution.converged);
        CHECK(independent_error(problem, solution.reaction) <= tolerance * (1 + 1e-6));
    }
    CHECK(count >= 18);
}
