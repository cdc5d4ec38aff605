#include "tests/contract/project_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

namespace skerry::test {

namespace {

const std::filesystem::path root = SKERRY_SOURCE_DIR;

bool is_source(const std::filesystem::path& file) {
    if (file.parent_path().parent_path().filename() == "found") return false;  // files found by fuzzers hold any bytes
    static const std::set<std::string> extensions{".h", ".cpp", ".cmake", ".py", ".js", ".sh", ".html", ".css", ""};
    return extensions.contains(file.extension().string()) || file.filename() == "CMakeLists.txt" ||
           file.filename() == "packages.txt";
}

ProjectFile read(const std::filesystem::path& file) {
    ProjectFile read{std::filesystem::relative(file, root).generic_string(), {}};
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) read.lines.push_back(line);
    return read;
}

}  // namespace

std::vector<ProjectFile> project_files() {
    std::vector<ProjectFile> files;
    for (const char* folder :
         {"components", "jobs", "systems", "engine", "examples", "profiling", "tests", "cmake", "scripts", ".ci"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder))
            if (entry.is_regular_file() && is_source(entry.path())) files.push_back(read(entry.path()));
    std::sort(files.begin(), files.end(), [](const ProjectFile& a, const ProjectFile& b) { return a.path < b.path; });
    return files;
}

std::vector<ProjectFile> project_texts() {
    static const std::set<std::string> extensions{".md", ".json", ".txt", ".dot"};
    std::vector<ProjectFile> files;
    const auto take = [&](const std::filesystem::directory_entry& entry) {
        if (entry.is_regular_file() && extensions.contains(entry.path().extension().string()))
            files.push_back(read(entry.path()));
    };
    for (const auto& entry : std::filesystem::directory_iterator(root)) take(entry);
    for (const char* folder : {"docs", "scenes"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) take(entry);
    std::sort(files.begin(), files.end(), [](const ProjectFile& a, const ProjectFile& b) { return a.path < b.path; });
    return files;
}

bool project_has(const std::string& path) {
    return std::filesystem::is_regular_file(root / path);
}

ProjectFile project_file(const std::string& path) {
    return read(root / path);
}

}  // namespace skerry::test
