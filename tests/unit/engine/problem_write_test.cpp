// Writing of problems to files.
#include <hdf5.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "problem_samples.h"
#include "skerry/error.h"
#include "tests/support/message_of.h"

namespace skerry::test::problem_write_test {

namespace fs = std::filesystem;

namespace {

/// "class:bytes:rank:size" of every data set, by path.
std::map<std::string, std::string> shapes_in(const fs::path& path) {
    std::map<std::string, std::string> shapes;
    const auto visit = [](hid_t file, const char* name, const H5O_info_t* info, void* into) -> herr_t {
        if (info->type != H5O_TYPE_DATASET) return 0;
        const hid_t data = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(data), space = H5Dget_space(data);
        const char* kind = H5Tget_class(type) == H5T_INTEGER ? "integer"
                           : H5Tget_class(type) == H5T_FLOAT ? "real"
                                                             : "text";
        (*static_cast<std::map<std::string, std::string>*>(into))[name] =
            kind + std::string(":") + std::to_string(H5Tget_size(type)) + ":" +
            std::to_string(H5Sget_simple_extent_ndims(space)) + ":" +
            std::to_string(H5Sget_simple_extent_npoints(space));
        H5Sclose(space);
        H5Tclose(type);
        H5Dclose(data);
        return 0;
    };
    const hid_t file = H5Fopen(path.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    H5Ovisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &shapes);
    H5Fclose(file);
    return shapes;
}

std::vector<double> numbers(const fs::path& path, const char* name, std::size_t count) {
    std::vector<double> values(count);
    const hid_t file = H5Fopen(path.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                data = H5Dopen2(file, name, H5P_DEFAULT);
    H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data);
    H5Fclose(file);
    return values;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal_to_write(const ContactProblem& problem, const fs::path& path, std::span<const Vec3> reaction = {}) {
    return message_of([&] { write_problem(problem, path, reaction); });
}

}  // namespace

TEST_CASE("a file has the groups, names and types of FCLIB's own writer", "[unit][problem]") {
    const TemporaryFolder folder;
    ContactProblem problem = read_back(local_file());
    problem.name = "sample";
    problem.description = "two contacts";
    const std::vector<Vec3> reaction{{0.3, 0.1, -0.2}, {0.9, -0.3, 0.1}};
    const fs::path path = folder.path() / "deep" / "sample.hdf5";
    write_problem(problem, path, reaction);
    auto shapes = shapes_in(path);
    CHECK(shapes["fclib_local/info/math_info"].starts_with("text:"));
    shapes.erase("fclib_local/info/math_info");
    const std::map<std::string, std::string> expected{
        {"fclib_local/spacedim", "integer:4:1:1"},
        {"fclib_local/W/nzmax", "integer:4:1:1"},
        {"fclib_local/W/m", "integer:4:1:1"},
        {"fclib_local/W/n", "integer:4:1:1"},
        {"fclib_local/W/nz", "integer:4:1:1"},
        {"fclib_local/W/p", "integer:4:1:7"},
        {"fclib_local/W/i", "integer:4:1:20"},
        {"fclib_local/W/x", "real:8:1:20"},
        {"fclib_local/vectors/q", "real:8:1:6"},
        {"fclib_local/vectors/mu", "real:8:1:2"},
        {"fclib_local/info/title", "text:7:0:1"},
        {"fclib_local/info/description", "text:13:0:1"},
        {"solution/u", "real:8:1:6"},
        {"solution/r", "real:8:1:6"},
    };
    CHECK(shapes == expected);
    CHECK(numbers(path, "/fclib_local/W/nz", 1)[0] == -1);
    const std::vector<double> r = numbers(path, "/solution/r", 6), u = numbers(path, "/solution/u", 6);
    const std::vector<Vec3> velocity = velocities(problem, reaction);
    for (std::size_t k = 0; k < 6; ++k) {
        CHECK(r[k] == reaction[k / 3][static_cast<int>(k % 3)]);
        CHECK(u[k] == velocity[k / 3][static_cast<int>(k % 3)]);
    }
    CHECK(std::distance(fs::directory_iterator(path.parent_path()), {}) == 1);  // no temporary file remains
}

TEST_CASE("a written problem is the problem, bit for bit, and so are its bytes", "[unit][problem]") {
    const TemporaryFolder folder;
    ContactProblem problem = read_back(local_file());  // W is not symmetric: exchanged rows and columns are noticed
    problem.description = "two contacts";
    const fs::path path = folder.path() / "a.hdf5";
    write_problem(problem, path);
    CHECK(shapes_in(path).count("solution/r") == 0);
    const ContactProblem again = read_problem(path);
    CHECK(difference(again, problem) == 0);
    CHECK(again.column == problem.column);
    CHECK(again.name == "a");
    CHECK(again.description == "two contacts");
    const std::string bytes = bytes_of(path);
    write_problem(problem, path);
    CHECK(bytes_of(path) == bytes);
}

TEST_CASE("errors of writing leave the earlier file", "[unit][problem]") {
    const TemporaryFolder folder;
    const fs::path path = folder.write("old.hdf5", "old");
    ContactProblem problem = read_back(local_file());
    CHECK(refusal_to_write(problem, path, std::vector<Vec3>(1)).find("1 values") != std::string::npos);
    ContactProblem empty;
    empty.row_offset = {0};
    CHECK(refusal_to_write(empty, path).find("no contacts") != std::string::npos);
    CHECK(refusal_to_write({}, path).find("row_offset") != std::string::npos);
    ContactProblem broken = problem;
    std::swap(broken.row_offset[0], broken.row_offset[1]);
    CHECK(refusal_to_write(broken, path).find("at entry 0") != std::string::npos);
    broken = problem;
    std::swap(broken.row_offset[1], broken.row_offset[2]);
    CHECK(refusal_to_write(broken, path).find("at entry 2, expected an offset >=") != std::string::npos);
    broken = problem;
    broken.mu[1] = -0.5;
    CHECK(refusal_to_write(broken, path).find("at entry 1, expected friction coefficients >= 0") != std::string::npos);
    broken = problem;
    broken.block.back()(2, 1) = infinity;
    CHECK(refusal_to_write(broken, path).find("block: found a value that is not finite") != std::string::npos);
    broken = problem;
    broken.block[1](0, 1) += 1;
    CHECK(refusal_to_write(broken, path).find("found a matrix W that is not symmetric in the rows of contact 0") !=
          std::string::npos);
    broken = problem;
    broken.column[0] = broken.column[1];
    CHECK(refusal_to_write(broken, path).find("columns that do not ascend in row 0") != std::string::npos);
    CHECK(bytes_of(path) == "old");
    CHECK(refusal_to_write(problem, path / "inside.hdf5").find("old.hdf5") != std::string::npos);
}

TEST_CASE("a part of a problem keeps the blocks within it", "[unit][problem]") {
    const ContactProblem problem = read_back(global_file());
    const ContactProblem part = part_of(problem, std::vector<Index>{0, 2});
    CHECK(part.column == std::vector<Index>{0, 1});
    CHECK(part.block[1] == problem.block.back());
    CHECK(part.q[1] == problem.q[2]);
    CHECK(part.mu[1] == problem.mu[2]);
    CHECK_THROWS_AS(part_of(problem, std::vector<Index>{2, 0}), SceneError);
    CHECK_THROWS_AS(part_of(problem, std::vector<Index>{3}), SceneError);
    CHECK(part_of(problem, {}).contacts() == 0);
}

}  // namespace skerry::test::problem_write_test
