// FCLIB files for the tests. The library does not write them, so that one thing at a time can be made wrong.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "skerry/problem.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test {

/// Data sets by their path inside the root group.
struct FclibFile {
    std::string root = "fclib_local";
    std::map<std::string, std::vector<int>> integers;
    std::map<std::string, std::vector<double>> reals;
    std::map<std::string, std::string> texts;
    std::vector<std::string> empty_groups;

    /// Removes a data set, or a group with its contents.
    void leave_out(const std::string& path);
    std::filesystem::path write(const std::filesystem::path& folder) const;
};

/// Two contacts, with W in compressed columns.
FclibFile local_file();
/// Three bodies with three degrees of freedom each (the second with a full M) and three contacts: ground and 1, 1 and
/// 2, 2 and 3. Columns are dense.
FclibFile global_file();

/// Storage formats of a matrix.
enum class Storage { columns, rows, triplets };
/// Converts the matrix of a group from compressed columns to another format.
void store(FclibFile& file, const std::string& group, Storage storage);
/// The full matrix, row by row, of a group in compressed columns.
std::vector<std::vector<double>> full(const FclibFile& file, const std::string& group);

ContactProblem read_back(const FclibFile& file);
/// Error message of the reader for the file, or "read".
std::string refusal_of(const std::filesystem::path& path);
std::string refusal(const FclibFile& file);
/// Checks that every word is in the text.
void check_says(const std::string& text, std::initializer_list<const char*> words);

/// One entry of W.
Real entry(const ContactProblem& problem, int row, int column);
/// u = W r + q.
std::vector<Vec3> velocities(const ContactProblem& problem, const std::vector<Vec3>& reaction);
/// |e| / max(|q|, |r|, |u|) from docs/methods/errors.md 3, without code of the library.
Real independent_error(const ContactProblem& problem, const std::vector<Vec3>& reaction);
/// Largest difference of two problems in W, q and mu.
Real difference(const ContactProblem& a, const ContactProblem& b);

/// Folder with FCLIB problems of others, which this project cannot distribute: `friction_problems` inside the folder
/// named by the environment variable SKERRY_TEST_DATA; nothing if that is not set.
std::optional<std::filesystem::path> problems_of_others();

}  // namespace skerry::test
