#include "engine/program/require_writable.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_output(const std::filesystem::path& path, const std::string& found,
                                const std::string& expected) {
    refuse_in(path.string(), "output", {}, found, expected);
}

}  // namespace

void require_writable_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::path existing = std::filesystem::absolute(folder);
    if (!existing.has_filename()) existing = existing.parent_path();  // removes a trailing slash
    while (!std::filesystem::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
    if (!std::filesystem::is_directory(existing, error))
        refuse_output(folder, existing.string() + ", which is not a folder", "a folder");
    if (access(existing.c_str(), W_OK | X_OK) != 0)
        refuse_output(
            folder, "the error \"" + std::generic_category().message(errno) + "\" for the folder " + existing.string(),
            "a folder with write permission");
}

void require_writable_file(const std::filesystem::path& file) {
    std::error_code error;
    if (file.filename().empty() || std::filesystem::is_directory(file, error))
        refuse_output(file, "a folder", "the name of a file");
    require_replaceable(file);
    require_writable_folder(std::filesystem::absolute(file).parent_path());
}

void require_distinct(std::span<const NamedFile> files) {
    for (std::size_t i = 0; i < files.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            if (files[i].file.empty() || files[k].file.empty() || real_path(files[i].file) != real_path(files[k].file))
                continue;
            std::error_code error;
            const std::filesystem::file_status found = std::filesystem::status(files[i].file, error);
            // a device such as /dev/null may be named several times
            if (std::filesystem::exists(found) && !std::filesystem::is_regular_file(found)) continue;
            refuse_in(files[i].file.string(), files[i].name, {}, "the same file as " + std::string(files[k].name),
                      "a different file", "choose another file name");
        }
}

}  // namespace skerry
