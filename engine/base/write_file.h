// Writes a file so that it appears either complete or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string_view>

#include "jobs/function_ref.h"

namespace skerry {

/// Creates the folder if it does not exist. Throws SceneError that names the folder if it cannot be created or is not a
/// folder.
void make_folder(const std::filesystem::path& folder);

/// Throws SceneError unless the file has one of the extensions, for example ".usd".
void require_extension(const std::filesystem::path& file, std::initializer_list<std::string_view> extensions);

/// Throws SceneError if write_file would refuse to replace an existing object of this name. Writable regular files and
/// streams such as pipes and terminals are accepted. Symbolic links are followed.
void require_replaceable(const std::filesystem::path& file);

/// Returns the absolute path of a file that may not exist yet, with symbolic links followed. If this fails, links are
/// kept.
std::filesystem::path real_path(const std::filesystem::path& file);

/// A temporary file in the folder of `file`, which commit() renames to `file`. So other programs never see an
/// incomplete file, and a failure leaves the old file unchanged. All functions throw SceneError that names the file and
/// the cause.
/// - The folder is created if needed.
/// - The new file gets the permissions of the old one.
/// - If `file` is a symbolic link, its target is replaced.
/// - Pipes and terminals are written directly.
class FileReplacement {
public:
    explicit FileReplacement(const std::filesystem::path& file);
    /// Removes the temporary file, unless commit() has renamed it.
    ~FileReplacement();
    FileReplacement(const FileReplacement&) = delete;
    FileReplacement& operator=(const FileReplacement&) = delete;

    std::fstream& stream() { return stream_; }
    /// Throws if `file` is a pipe or a terminal. The stream can otherwise also seek and read.
    std::fstream& seekable_stream();
    /// Throws if the bytes so far could not be written.
    void require_written();
    void commit();

    /// File or stream to which the bytes are written. Symbolic links are resolved.
    struct Target {
        std::filesystem::path path;
        bool takes_bytes = false;  // true for a pipe or a terminal, which is written directly
        std::filesystem::perms permissions = std::filesystem::perms::unknown;  // permissions of the file to be replaced
    };

private:
    std::filesystem::path file_;
    Target target_;
    std::filesystem::path part_;
    std::fstream stream_;
};

/// Writes a file by FileReplacement.
void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write);

}  // namespace skerry
