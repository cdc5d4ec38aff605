// The files of the project, as the tests of the house read them.
#pragma once

#include <string>
#include <vector>

namespace skerry::test {

struct ProjectFile {
    std::string path;  // from the root of the project, with /
    std::vector<std::string> lines;
};

/// All source files: code, build, scripts. In the order of their paths.
std::vector<ProjectFile> project_files();

/// Whether there is such a file in the project.
bool project_has(const std::string& path);

}  // namespace skerry::test
