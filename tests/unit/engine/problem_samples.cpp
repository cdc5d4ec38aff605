#include "problem_samples.h"

#include <hdf5.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "tests/support/message_of.h"

namespace skerry::test {
namespace fs = std::filesystem;

namespace {

void make_groups(hid_t file, const std::string& path) {
    for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1)) {
        const std::string group = path.substr(0, end);
        if (H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0) continue;
        H5Gclose(H5Gcreate2(file, group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
}

void put(hid_t file, const std::string& path, hid_t type, hid_t space, const void* values) {
    make_groups(file, path);
    const hid_t data = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (values) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(data);
    H5Sclose(space);
}

template <class T>
void put(hid_t file, const std::string& path, const std::vector<T>& values) {
    const hsize_t size = values.size();
    put(file, path, std::is_same_v<T, int> ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE, H5Screate_simple(1, &size, nullptr),
        values.empty() ? nullptr : values.data());
}

/// Stores a full matrix in compressed columns without its zeros.
void put_columns(FclibFile& file, const std::string& group, const std::vector<std::vector<double>>& rows) {
    const std::size_t m = rows.size(), n = rows[0].size();
    std::vector<int> begin{0}, row;
    std::vector<double> value;
    for (std::size_t c = 0; c < n; ++c) {
        for (std::size_t r = 0; r < m; ++r)
            if (rows[r][c] != 0) {
                row.push_back(static_cast<int>(r));
                value.push_back(rows[r][c]);
            }
        begin.push_back(static_cast<int>(row.size()));
    }
    file.integers[group + "/m"] = {static_cast<int>(m)};
    file.integers[group + "/n"] = {static_cast<int>(n)};
    file.integers[group + "/nz"] = {-1};
    file.integers[group + "/nzmax"] = {static_cast<int>(row.size())};
    file.integers[group + "/p"] = begin;
    file.integers[group + "/i"] = row;
    file.reals[group + "/x"] = value;
}

}  // namespace

void FclibFile::leave_out(const std::string& path) {
    const auto within = [&](const auto& item) { return item.first == path || item.first.starts_with(path + "/"); };
    std::erase_if(integers, within);
    std::erase_if(reals, within);
}

fs::path FclibFile::write(const fs::path& folder) const {
    static int count = 0;
    const fs::path path = folder / ("problem_" + std::to_string(count++) + ".hdf5");
    const hid_t file = H5Fcreate(path.string().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const std::string begin = "/" + root + "/";
    make_groups(file, begin);
    for (const auto& [name, values] : integers) put(file, begin + name, values);
    for (const auto& [name, values] : reals) put(file, begin + name, values);
    for (const auto& [name, text] : texts) {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        const char* const characters = text.c_str();
        put(file, begin + name, type, H5Screate(H5S_SCALAR), &characters);
        H5Tclose(type);
    }
    for (const std::string& group : empty_groups) make_groups(file, begin + group + "/");
    H5Fclose(file);
    return path;
}

FclibFile local_file() {
    FclibFile file;
    file.integers = {{"spacedim", {3}}, {"W/m", {6}}, {"W/n", {6}}, {"W/nz", {-1}}, {"W/nzmax", {20}}};
    const std::vector<int> p{0, 4, 8, 11, 14, 17, 20}, i{0, 1, 3, 4, 0, 1, 3, 4, 2, 3, 5, 0, 2, 3, 1, 4, 5, 2, 4, 5};
    // W is symmetric within the errors of files, and not exactly, so that swapped rows and columns show.
    std::vector<double> x;
    for (std::size_t k = 0; k < i.size(); ++k) x.push_back(0.001 * static_cast<double>(k + 1));
    for (std::size_t column = 0; column < 6; ++column)
        for (auto k = static_cast<std::size_t>(p[column]); k < static_cast<std::size_t>(p[column + 1]); ++k)
            if (i[k] == static_cast<int>(column)) x[k] = 2;
    file.integers["W/p"] = p;
    file.integers["W/i"] = i;
    file.reals = {{"W/x", x}, {"vectors/q", {-1, 0.5, 0.1, -2, 0.3, -0.2}}, {"vectors/mu", {0.5, 0.3}}};
    return file;
}

FclibFile global_file() {
    FclibFile file;
    file.root = "fclib_global";
    file.integers["spacedim"] = {3};
    std::vector<std::vector<double>> mass(9, std::vector<double>(9, 0.0));
    for (std::size_t k = 0; k < 9; ++k) mass[k][k] = k < 3 ? 2 : k < 6 ? 4 : 0.5;
    mass[3][4] = mass[4][3] = 1;
    mass[4][5] = mass[5][4] = -0.5;
    put_columns(file, "M", mass);
    // Contact 0 is turned about z, so that H has entries other than zeros and ones. Contacts 1 and 2 lie along the
    // axes.
    std::vector<std::vector<double>> h(9, std::vector<double>(9, 0.0));
    const double c = 0.8, s = 0.6;
    h[0][0] = c, h[1][0] = s, h[0][1] = -s, h[1][1] = c, h[2][2] = 1;
    for (std::size_t k = 0; k < 3; ++k)
        h[k][3 + k] = -1, h[3 + k][3 + k] = 1, h[3 + k][6 + k] = -1, h[6 + k][6 + k] = 1;
    put_columns(file, "H", h);
    file.reals["vectors/f"] = {-3, 1, 0.5, -8, 2, -1, -2, 0.3, 0.7};
    file.reals["vectors/w"] = {0, 0, 0.1, -0.2, 0, 0, 0.05, 0, 0};
    file.reals["vectors/mu"] = {0.5, 0.3, 0.8};
    return file;
}

std::vector<std::vector<double>> full(const FclibFile& file, const std::string& group) {
    const auto size = [&](const char* name) { return static_cast<std::size_t>(file.integers.at(group + name)[0]); };
    const std::vector<int>&p = file.integers.at(group + "/p"), &i = file.integers.at(group + "/i");
    const std::vector<double>& x = file.reals.at(group + "/x");
    std::vector<std::vector<double>> rows(size("/m"), std::vector<double>(size("/n"), 0.0));
    for (std::size_t c = 0; c < size("/n"); ++c)
        for (auto k = static_cast<std::size_t>(p[c]); k < static_cast<std::size_t>(p[c + 1]); ++k)
            rows[static_cast<std::size_t>(i[k])][c] += x[k];
    return rows;
}

void store(FclibFile& file, const std::string& group, Storage storage) {
    if (storage == Storage::columns) return;
    const std::vector<std::vector<double>> rows = full(file, group);
    std::vector<int> begin{0}, row, column;
    std::vector<double> value;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            if (rows[r][c] != 0) {
                row.push_back(static_cast<int>(r));
                column.push_back(static_cast<int>(c));
                value.push_back(rows[r][c]);
            }
        begin.push_back(static_cast<int>(row.size()));
    }
    const bool triplets = storage == Storage::triplets;
    file.integers[group + "/nz"] = {triplets ? static_cast<int>(row.size()) : -2};
    file.integers[group + "/nzmax"] = {static_cast<int>(row.size())};
    file.integers[group + "/p"] = triplets ? column : begin;
    file.integers[group + "/i"] = triplets ? row : column;
    file.reals[group + "/x"] = value;
}

ContactProblem read_back(const FclibFile& file) {
    const TemporaryFolder folder;
    return read_problem(file.write(folder.path()));
}

std::string refusal_of(const fs::path& path) {
    return message_of([&] { read_problem(path); });
}

std::string refusal(const FclibFile& file) {
    const TemporaryFolder folder;
    const fs::path path = file.write(folder.path());
    const std::string text = refusal_of(path);
    CHECK(text.find(path.filename().string()) != std::string::npos);
    return text;
}

Real entry(const ContactProblem& problem, int row, int column) {
    for (Index k = problem.row_offset[row / 3]; k < problem.row_offset[row / 3 + 1]; ++k)
        if (problem.column[k] == column / 3) return problem.block[k](row % 3, column % 3);
    return 0;
}

std::vector<Vec3> velocities(const ContactProblem& problem, const std::vector<Vec3>& reaction) {
    std::vector<Vec3> u = problem.q;
    for (std::size_t c = 0; c < u.size(); ++c)
        for (Index k = problem.row_offset[c]; k < problem.row_offset[c + 1]; ++k)
            u[c] += problem.block[k] * reaction[problem.column[k]];
    return u;
}

Real independent_error(const ContactProblem& problem, const std::vector<Vec3>& reaction) {
    Real lack = 0, q2 = 0, r2 = 0, u2 = 0;
    const std::vector<Vec3> velocity = velocities(problem, reaction);
    for (std::size_t c = 0; c < problem.q.size(); ++c) {
        const Vec3 u = velocity[c], r = reaction[c];
        const Real mu = problem.mu[c];
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

void check_says(const std::string& text, std::initializer_list<const char*> words) {
    for (const char* word : words) {
        INFO(text);
        CHECK(text.find(word) != std::string::npos);
    }
}

Real difference(const ContactProblem& a, const ContactProblem& b) {
    REQUIRE(a.contacts() == b.contacts());
    Real largest = 0;
    for (int row = 0; row < 3 * a.contacts(); ++row)
        for (int column = 0; column < 3 * a.contacts(); ++column)
            largest = std::max(largest, std::abs(entry(a, row, column) - entry(b, row, column)));
    for (Index i = 0; i < a.contacts(); ++i)
        largest = std::max({largest, (a.q[i] - b.q[i]).cwiseAbs().maxCoeff(), std::abs(a.mu[i] - b.mu[i])});
    return largest;
}

std::optional<fs::path> problems_of_others() {
    const char* folder = std::getenv("SKERRY_TEST_DATA");
    if (folder == nullptr) return std::nullopt;
    return fs::path(folder) / "friction_problems";
}

}  // namespace skerry::test
