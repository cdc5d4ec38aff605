// Local problems from files: every storage format and every kind of error.
#include <hdf5.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <limits>

#include "problem_samples.h"

namespace skerry::test::problem_read_test {

namespace fs = std::filesystem;

TEST_CASE("a written problem reads back entry by entry", "[unit][problem]") {
    FclibFile file = local_file();
    file.texts["info/description"] = "two contacts";
    const ContactProblem problem = read_back(file);
    REQUIRE(problem.contacts() == 2);
    CHECK(problem.mu == file.reals["vectors/mu"]);
    CHECK(problem.q[1] == Vec3(-2, 0.3, -0.2));
    CHECK(problem.description == "two contacts");
    CHECK(problem.freedoms == 0);
    const auto expected = full(file, "W");
    for (int row = 0; row < 6; ++row)
        for (int column = 0; column < 6; ++column)
            CHECK(entry(problem, row, column) ==
                  expected[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]);
}

TEST_CASE("rows and triplets are read like columns", "[unit][problem]") {
    const ContactProblem by_columns = read_back(local_file());
    for (const Storage storage : {Storage::rows, Storage::triplets}) {
        FclibFile file = local_file();
        store(file, "W", storage);
        CHECK(difference(read_back(file), by_columns) == 0);
    }
}

TEST_CASE("every malformed file is refused, and the error names the fault", "[unit][problem]") {
    const auto spoil = [](const std::function<void(FclibFile&)>& change) {
        FclibFile file = local_file();
        change(file);
        return refusal(file);
    };
    check_says(spoil([](auto& f) { f.integers["spacedim"] = {2}; }), {"fclib_local", "spacedim", "2", "expected 3"});
    check_says(spoil([](auto& f) { f.integers["spacedim"] = {3, 3}; }), {"spacedim", "2 values", "one integer"});
    for (const char* name :
         {"W", "vectors", "spacedim", "W/m", "W/n", "W/nz", "W/nzmax", "W/p", "W/i", "W/x", "vectors/q", "vectors/mu"})
        check_says(spoil([&](auto& f) { f.leave_out(name); }), {fs::path(name).filename().c_str(), "nothing"});
    check_says(spoil([](auto& f) { f.root = "something"; }),
               {"fclib_local", "nothing", "a group", "no FCLIB contact problem"});
    check_says(spoil([](auto& f) { f.empty_groups = {"V"}; }), {"V", "equality constraints"});
    check_says(spoil([](auto& f) { f.integers["W/m"] = f.integers["W/n"] = {7}; }), {"W", "m", "7", "multiple of 3"});
    check_says(spoil([](auto& f) { f.integers["W/m"] = {0}; }), {"W", "m", "0"});
    check_says(spoil([](auto& f) { f.integers["W/m"] = {-3}; }), {"W", "m", "-3", "a number of rows >= 0"});
    check_says(spoil([](auto& f) { f.integers["W/n"] = {9}; }), {"n", "9", "6"});
    check_says(spoil([](auto& f) { f.integers["W/nz"] = {-3}; }), {"nz", "-3"});
    check_says(spoil([](auto& f) { f.integers["W/p"].pop_back(); }), {"W", "p", "6 values", "7"});
    check_says(spoil([](auto& f) { f.integers["W/i"].pop_back(); }), {"i", "19 values", "20"});
    check_says(spoil([](auto& f) { f.reals["W/x"].pop_back(); }), {"x", "19 values", "20"});
    check_says(spoil([](auto& f) { std::swap(f.integers["W/p"][1], f.integers["W/p"][2]); }), {"p", "ascend"});
    check_says(spoil([](auto& f) { f.integers["W/p"].back() = 21; }), {"p", "21 at entry 6", "<= 20"});
    check_says(spoil([](auto& f) { f.integers["W/i"][3] = 6; }), {"i", "index 6", "0 to 5"});
    check_says(spoil([](auto& f) { f.integers["W/i"][3] = -1; }), {"i", "index -1"});
    check_says(spoil([](auto& f) { f.integers["W/nz"] = {30}; }), {"W", "p", "7 values", "30"});
    check_says(spoil([](auto& f) {
                   f.reals["W/p"] = std::vector<double>(7, 0.0);
                   f.integers.erase("W/p");
               }),
               {"p", "found floating-point numbers", "expected integers"});
    check_says(spoil([](auto& f) { f.reals["vectors/q"].pop_back(); }), {"vectors", "q", "5 values", "6"});
    check_says(spoil([](auto& f) { f.reals["vectors/mu"].push_back(1); }), {"mu", "3 values", "2"});
    check_says(spoil([](auto& f) { f.reals["vectors/mu"][1] = -0.1; }), {"mu", "-0.1", ">= 0"});
    check_says(spoil([](auto& f) { f.reals["vectors/q"][2] = std::numeric_limits<double>::quiet_NaN(); }),
               {"q", "nan", "entry 2", "finite"});
    check_says(spoil([](auto& f) { f.reals["W/x"][4] = std::numeric_limits<double>::infinity(); }),
               {"x", "inf", "entry 4", "finite"});
    check_says(spoil([](auto& f) { f.reals["vectors/mu"][0] = std::numeric_limits<double>::quiet_NaN(); }),
               {"mu", "nan"});
    // Every number is finite, but their sum is not.
    check_says(spoil([](auto& f) {
                   f.integers["W/i"][1] = 0;
                   f.reals["W/x"][0] = f.reals["W/x"][1] = 1.7e308;
               }),
               {"W", "not finite"});
}

namespace {

/// Message of the reader for a local problem whose data set `q` has this type and size, and no values.
std::string refusal_of_empty_q(hid_t type, hsize_t size) {
    const TemporaryFolder folder;
    const fs::path path = local_file().write(folder.path());
    const hid_t file = H5Fopen(path.string().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, "/fclib_local/vectors/q", H5P_DEFAULT);
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    H5Dclose(H5Dcreate2(file, "/fclib_local/vectors/q", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Fclose(file);
    CHECK(fs::file_size(path) < 100000);
    return refusal_of(path);
}

}  // namespace

TEST_CASE("a data set that claims more than its file can contain is refused before memory is allocated",
          "[unit][problem]") {
    CHECK_THAT(refusal_of_empty_q(H5T_NATIVE_DOUBLE, 2000000000),
               Catch::Contains("2000000000 values, expected a number of values that fits the size of the file"));
    const hid_t wide = H5Tcopy(H5T_NATIVE_INT);
    H5Tset_size(wide, 1000000);
    CHECK_THAT(refusal_of_empty_q(wide, 6),
               Catch::Contains("values of 1000000 bytes, expected numbers of at most 16 bytes"));
    H5Tclose(wide);
    CHECK_THAT(refusal_of_empty_q(H5T_NATIVE_DOUBLE, 6), Catch::Contains("fewer bytes than 6 values need"));
}

TEST_CASE("a file that is missing, a folder, or not HDF5 is refused", "[unit][problem]") {
    const TemporaryFolder folder;
    CHECK(refusal_of("/no/such/file.hdf5").find("no such file") != std::string::npos);
    CHECK(refusal_of(folder.path()).find("found a folder") != std::string::npos);
    CHECK(refusal_of(folder.write("text.txt", "not HDF5")).find("not in HDF5 format") != std::string::npos);
    const fs::path whole = local_file().write(folder.path());
    fs::resize_file(whole, fs::file_size(whole) / 2);  // an interrupted download
    CHECK(refusal_of(whole) != "read");
}

}  // namespace skerry::test::problem_read_test
