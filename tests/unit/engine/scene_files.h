// Scene files that live as long as a test.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace skerry {

/// A folder of its own for files that a test writes.
class TemporaryFolder {
public:
    TemporaryFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() / ("skerry_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = path_ / name;
        std::ofstream(file, std::ios::binary) << text;
        return file;
    }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A small scene with `more` keys at its top.
inline std::string scene_with(const std::string& more) {
    return R"({"materials": {"rubber": {"E": 1e5}}, "bodies": [{"name": "ball", "mesh": {"ball": {"radius": 0.1, "resolution": 3}}, "material": "rubber"}])" +
           (more.empty() ? std::string() : ", " + more) + "}";
}

/// A small scene whose only body has `more` keys.
inline std::string body_with(const std::string& more) {
    return R"({"materials": {"rubber": {}}, "bodies": [{"name": "block", "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber")" +
           (more.empty() ? std::string() : ", " + more) + "}]}";
}

/// A small scene whose only material has these keys.
inline std::string material_with(const std::string& keys) {
    return R"({"materials": {"rubber": {)" + keys +
           R"(}}, "bodies": [{"mesh": {"ball": {"radius": 1, "resolution": 3}}, "material": "rubber"}]})";
}

}  // namespace skerry
