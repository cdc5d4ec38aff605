// The files of the project, as read by the contract tests.
#pragma once

#include <string>
#include <vector>

namespace skerry::test {

struct ProjectFile {
    std::string path;  // relative to the root of the project, with /
    std::vector<std::string> lines;
};

/// All source files (code, build, scripts, pages), sorted by path.
std::vector<ProjectFile> project_files();

/// All other texts: README, changelog, docs, scenes, and the build files in the root.
std::vector<ProjectFile> project_texts();

/// True if the project has a file at this path.
bool project_has(const std::string& path);

/// A file of the project, which must exist.
ProjectFile project_file(const std::string& path);

}  // namespace skerry::test
