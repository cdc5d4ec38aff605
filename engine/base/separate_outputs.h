// Keeps the outputs of different runs apart.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "jobs/function_ref.h"
#include "skerry/error.h"

namespace skerry {

/// Error of an output that another process has reserved.
class OutputReserved : public SceneError {
public:
    using SceneError::SceneError;
};

/// Reserves an output for this process until the object is destroyed. It locks a file next to the output, whose text
/// names the process, and removes the file at the end. The system releases the lock of a killed process. On a file
/// system without locks, other processes are not kept away.
class OutputLock {
public:
    /// Creates the folder of `lock_file` if it is missing. `user`: scene or command, for messages of other processes.
    /// Throws OutputReserved, which names the other process, if the output is reserved. Throws SceneError if the file
    /// cannot be made, or if it is a file of a user. The parts of both errors are those of `output`. An empty
    /// `lock_file` reserves nothing.
    OutputLock(const std::filesystem::path& lock_file, Complaint output, std::string_view user);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

/// Files that an earlier run wrote to the folder of an output.
class EarlierFiles {
public:
    EarlierFiles() = default;
    /// Lists the regular files of `folder` that `is_own` recognises by their names, in the order of these names. Throws
    /// SceneError if a file cannot be replaced. A folder that does not exist has no files.
    EarlierFiles(const std::filesystem::path& folder, FunctionRef<bool(const std::string& name)> is_own);
    /// Takes a file from the list.
    void keep(const std::filesystem::path& file) { std::erase(files_, file); }
    /// Removes all files of the list in their order, and clears the list. Throws SceneError at the first failure.
    void remove();

private:
    std::vector<std::filesystem::path> files_;
};

}  // namespace skerry
