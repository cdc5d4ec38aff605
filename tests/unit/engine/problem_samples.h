// Files of FCLIB for the tests, written by other code than the library's, so that one thing can be spoilt at a time.
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

/// Data sets by path inside the root group.
struct FclibFile {
    std::string root = "fclib_local";
    std::map<std::string, std::vector<int>> integers;
    std::map<std::string, std::vector<double>> reals;
    std::map<std::string, std::string> texts;
    std::vector<std::string> empty_groups;

    /// Takes a data set, or a group with all in it, out.
    void leave_out(const std::string& path);
    std::filesystem::path write(const std::filesystem::path& folder) const;
};

/// Two contacts, W in compressed columns.
FclibFile local_file();
/// Three bodies of three freedoms each (the second with a full M), three contacts: ground and 1, 1 and 2, 2 and 3;
/// dense columns.
FclibFile global_file();

/// How a matrix is stored.
enum class Storage { columns, rows, triplets };
/// Stores the matrix of a group (given in compressed columns) in another way.
void store(FclibFile& file, const std::string& group, Storage storage);
/// The full matrix of a group in compressed columns, row by row.
std::vector<std::vector<double>> full(const FclibFile& file, const std::string& group);

ContactProblem read_back(const FclibFile& file);
/// What the reader says to the file, or "read".
std::string refusal_of(const std::filesystem::path& path);
std::string refusal(const FclibFile& file);
/// Every word is in the text.
void check_says(const std::string& text, std::initializer_list<const char*> words);

/// One entry of W.
Real entry(const ContactProblem& problem, int row, int column);
/// u = W r + q.
std::vector<Vec3> velocities(const ContactProblem& problem, const std::vector<Vec3>& reaction);
/// |e| / max(|q|, |r|, |u|), written down once more from docs/methods/errors.md 3, sharing no code with the library.
Real independent_error(const ContactProblem& problem, const std::vector<Vec3>& reaction);
/// The largest difference of two problems, in W, q and mu.
Real difference(const ContactProblem& a, const ContactProblem& b);

/// FCLIB problems of others are not ours to ship: the folder `friction_problems` of the one that SKERRY_TEST_DATA
/// names, if it does.
std::optional<std::filesystem::path> problems_of_others();

}  // namespace skerry::test
