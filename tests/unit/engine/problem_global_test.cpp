// Global problems: M v = H r + f, u = H^T v + w, condensed to the contacts.
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <functional>
#include <initializer_list>

#include "problem_samples.h"
#include "tests/support/dense_algebra.h"

namespace skerry::test::problem_global_test {

namespace {

Eigen::MatrixXd dense(const FclibFile& file, const std::string& group) {
    const auto rows = full(file, group);
    Eigen::MatrixXd matrix(rows.size(), rows[0].size());
    for (Eigen::Index r = 0; r < matrix.rows(); ++r)
        for (Eigen::Index c = 0; c < matrix.cols(); ++c)
            matrix(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    return matrix;
}

Eigen::VectorXd dense(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

TEST_CASE("a global problem is condensed to H^T M^-1 H and H^T M^-1 f + w, in every storage", "[unit][problem]") {
    const FclibFile sample = global_file();
    const Eigen::MatrixXd mass = dense(sample, "M"), h = dense(sample, "H");
    const Eigen::MatrixXd inverse = inverse_of(mass);
    const Eigen::MatrixXd w = h.transpose() * inverse * h;
    const Eigen::VectorXd q =
        h.transpose() * inverse * dense(sample.reals.at("vectors/f")) + dense(sample.reals.at("vectors/w"));
    for (const Storage mass_storage : {Storage::columns, Storage::rows, Storage::triplets})
        for (const Storage h_storage : {Storage::columns, Storage::rows, Storage::triplets}) {
            FclibFile file = sample;
            store(file, "M", mass_storage);
            store(file, "H", h_storage);
            INFO("M in storage " << static_cast<int>(mass_storage) << ", H in storage " << static_cast<int>(h_storage));
            const ContactProblem problem = read_back(file);
            REQUIRE(problem.contacts() == 3);
            CHECK(problem.freedoms == 9);
            CHECK(problem.mu == sample.reals.at("vectors/mu"));
            for (int row = 0; row < 9; ++row) {
                // Entries are of size 1 to 4: the margin allows a few roundings.
                CHECK(problem.q[row / 3][row % 3] == Approx(q[row]).margin(1e-14));
                for (int column = 0; column < 9; ++column) {
                    CHECK(entry(problem, row, column) == Approx(w(row, column)).margin(1e-14));
                    CHECK(entry(problem, row, column) == entry(problem, column, row));
                }
            }
        }
}

TEST_CASE("contacts on different bodies are not coupled by condensing", "[unit][problem]") {
    const ContactProblem problem = read_back(global_file());
    // Contacts 0 and 1 meet on the first body, 1 and 2 on the second, 0 and 2 on none.
    CHECK(problem.row_offset == std::vector<Index>{0, 2, 5, 7});
    CHECK(problem.column == std::vector<Index>{0, 1, 0, 1, 2, 1, 2});
}

TEST_CASE("couplings that cancel to rounding are dropped", "[unit][problem]") {
    // Two uncoupled contacts on one rigid body: 1/m - arm^2/I = 0 up to rounding, both along and across.
    FclibFile file;
    file.root = "fclib_global";
    file.integers["spacedim"] = {3};
    const double mass = 3, arm = 0.1, inertia = mass * arm * arm;
    file.integers.merge(
        std::map<std::string, std::vector<int>>{{"M/m", {6}}, {"M/n", {6}}, {"M/nz", {6}}, {"M/nzmax", {6}}});
    file.integers["M/p"] = file.integers["M/i"] = {0, 1, 2, 3, 4, 5};
    file.reals["M/x"] = {mass, mass, mass, inertia, inertia, inertia};
    std::vector<int> row, column;
    std::vector<double> value;
    for (int k = 0; k < 3; ++k)
        for (int contact = 0; contact < 2; ++contact) {
            row.insert(row.end(), {k, 3 + k});
            column.insert(column.end(), {3 * contact + k, 3 * contact + k});
            value.insert(value.end(), {1.0, contact == 0 ? arm : -arm});
        }
    const int entries = static_cast<int>(row.size());
    file.integers.merge(std::map<std::string, std::vector<int>>{
        {"H/m", {6}}, {"H/n", {6}}, {"H/nz", {entries}}, {"H/nzmax", {entries}}});
    file.integers["H/p"] = column;
    file.integers["H/i"] = row;
    file.reals["H/x"] = value;
    file.reals["vectors/f"] = {-1, 0, 0, 0, 0, 0};
    file.reals["vectors/w"] = {0, 0, 0, 0, 0, 0};
    file.reals["vectors/mu"] = {0.5, 0.5};
    const ContactProblem problem = read_back(file);
    CHECK(problem.column == std::vector<Index>{0, 1});
    CHECK(solve_problem(problem).regions == 2);
}

TEST_CASE("a condensed problem and the same problem as a local file have the same solution", "[unit][problem]") {
    const TemporaryFolder folder;
    const ContactProblem condensed = read_back(global_file());
    const ProblemSolution first = solve_problem(condensed, {.tolerance = 1e-12});
    REQUIRE(first.converged);
    write_problem(condensed, folder.path() / "local.hdf5", first.reaction);
    const ContactProblem local = read_problem(folder.path() / "local.hdf5");
    CHECK(local.freedoms == 0);
    CHECK(difference(local, condensed) == 0);
    const ProblemSolution second = solve_problem(local, {.tolerance = 1e-12});
    for (std::size_t i = 0; i < 3; ++i) CHECK(second.reaction[i] == first.reaction[i]);
}

TEST_CASE("a body of many contacts is condensed in batches as if at once", "[unit][problem]") {
    FclibFile file = global_file();
    const int contacts = 100;  // three batches and a remainder
    std::vector<int> row, column;
    std::vector<double> value;
    for (int c = 0; c < contacts; ++c)
        for (int a = 0; a < 3; ++a)
            for (int b = 3; b < 6; ++b) {
                row.push_back(b);
                column.push_back(3 * c + a);
                value.push_back(a == b - 3 ? 1 : 0.01 * c * (a - b));
            }
    file.integers["H/n"] = {3 * contacts};
    file.integers["H/nz"] = file.integers["H/nzmax"] = {static_cast<int>(row.size())};
    file.integers["H/p"] = column;
    file.integers["H/i"] = row;
    file.reals["H/x"] = value;
    file.reals["vectors/w"] = std::vector<double>(3 * contacts, 0.0);
    file.reals["vectors/mu"] = std::vector<double>(contacts, 0.5);
    const ContactProblem problem = read_back(file);
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(9, 3 * contacts);
    for (std::size_t k = 0; k < row.size(); ++k) h(row[k], column[k]) += value[k];
    const Eigen::MatrixXd w = h.transpose() * inverse_of(dense(file, "M")) * h;
    for (int r = 0; r < 3 * contacts; r += 7)
        // Entries are up to 20: the margin allows a few roundings.
        for (int c = 0; c < 3 * contacts; c += 5) CHECK(entry(problem, r, c) == Approx(w(r, c)).margin(1e-12));
}

TEST_CASE("every malformed global file is refused, and the error names the fault", "[unit][problem]") {
    const auto spoil = [](const std::function<void(FclibFile&)>& change) {
        FclibFile file = global_file();
        change(file);
        return refusal(file);
    };
    for (const char* name : {"M", "H", "vectors", "spacedim", "M/p", "H/x", "vectors/f", "vectors/w", "vectors/mu"})
        check_says(spoil([&](auto& f) { f.leave_out(name); }),
                   {"fclib_global", std::filesystem::path(name).filename().c_str(), "nothing"});
    check_says(spoil([](auto& f) { f.integers["spacedim"] = {2}; }), {"spacedim", "2"});
    check_says(spoil([](auto& f) { f.integers["M/n"] = {8}; }), {"M", "n", "8", "9"});
    check_says(spoil([](auto& f) { f.integers["H/m"] = {8}; }), {"H", "m", "8", "9 (rows of M)"});
    check_says(spoil([](auto& f) { f.integers["H/n"] = {8}; }), {"H", "n", "8", "multiple of 3"});
    check_says(spoil([](auto& f) { f.integers["H/n"] = {12}; }), {"H", "p", "10 values", "13"});
    check_says(spoil([](auto& f) { f.integers["H/i"][0] = 9; }), {"H", "i", "index 9", "0 to 8"});
    check_says(spoil([](auto& f) { f.reals["vectors/f"].pop_back(); }), {"vectors", "f", "8 values", "9"});
    check_says(spoil([](auto& f) { f.reals["vectors/w"].push_back(0); }), {"vectors", "w", "10 values", "9"});
    check_says(spoil([](auto& f) { f.reals["vectors/mu"].pop_back(); }), {"mu", "2 values", "3"});
    check_says(spoil([](auto& f) {
                   f.integers.merge(std::map<std::string, std::vector<int>>{{"G/m", {9}}, {"G/n", {1}}});
               }),
               {"G", "equality constraints"});
    check_says(spoil([](auto& f) { f.reals["M/x"][0] = -2; }),
               {"M", "-2", "diagonal entry of degree of freedom 0", "positive definite"});
    check_says(spoil([](auto& f) { f.reals["M/x"][4] = 2; }),
               {"M", "not symmetric", "degree of freedom 3", "degree of freedom 4"});
    // [4 4; 4 4] and its neighbour: singular, then indefinite
    check_says(spoil([](auto& f) { f.reals["M/x"][4] = f.reals["M/x"][5] = 4; }),
               {"M", "not positive definite", "degree of freedom 3"});
    check_says(spoil([](auto& f) { f.reals["M/x"][4] = f.reals["M/x"][5] = 40; }),
               {"M", "not positive definite", "degree of freedom 3"});
}

TEST_CASE("an empty set of equality constraints is none", "[unit][problem]") {
    FclibFile file = global_file();
    file.integers.merge(std::map<std::string, std::vector<int>>{{"G/m", {9}}, {"G/n", {0}}});
    CHECK(read_back(file).contacts() == 3);
}

}  // namespace skerry::test::problem_global_test
