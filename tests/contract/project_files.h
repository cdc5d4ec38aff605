// The files of the project, as the tests of the house read them.
#pragma once

#include <string>
#include <vector>

namespace skerry::test {

struct ProjectFile {
    std::string path;  // from the root of the project, with /
    std::vector<std::string> lines;
};

/// All source files: code, build, scripts, pages. In the order of their paths.
std::vector<ProjectFile> project_files();

/// The texts beside them: README, changelog, docs, scenes, the build's own files in the root.
std::vector<ProjectFile> project_texts();

/// Whether there is such a file in the project.
bool project_has(const std::string& path);

/// A file of the project, which has to be there.
ProjectFile project_file(const std::string& path);

}  // namespace skerry::test
