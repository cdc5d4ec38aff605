#include "engine/base/write_file.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "engine/base/complaint.h"

namespace skerry {
namespace {

std::string system_message(int error) {
    return std::generic_category().message(error);
}

[[noreturn]] void complain(const std::filesystem::path& path, const std::string& found, const std::string& expected,
                           const std::string& hint) {
    refuse_in(path.string(), "output", {}, found, expected, hint);
}

std::string failure(const std::string& message) {
    return "the error \"" + message + "\"";
}

const char* name_of(std::filesystem::file_type type) {
    switch (type) {
        case std::filesystem::file_type::directory:
            return "a folder";
        case std::filesystem::file_type::block:
            return "a block device";
        case std::filesystem::file_type::socket:
            return "a socket";
        default:
            return "an object that is not a regular file";
    }
}

FileReplacement::Target target_of(const std::filesystem::path& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status found = fs::status(file, error);
    if (found.type() == fs::file_type::character || found.type() == fs::file_type::fifo) return {file, true};
    if (fs::exists(found) && found.type() != fs::file_type::regular)
        complain(file, name_of(found.type()), "a file that can be written", "choose another path");
    if (found.type() == fs::file_type::none)
        complain(file, failure(error.message()), "a file that can be written", "check the path and its permissions");
    FileReplacement::Target target{file};
    constexpr int most_links = 40;
    for (int links = 0; links < most_links && fs::is_symlink(fs::symlink_status(target.path, error)); ++links) {
        const fs::path link_target = fs::read_symlink(target.path, error);
        target.path = link_target.is_absolute() ? link_target : target.path.parent_path() / link_target;
    }
    if (!fs::exists(found)) return target;
    // Renaming would also replace a write-protected file. Such a file is refused, because it was protected on purpose.
    constexpr fs::perms any_may_write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
    if ((found.permissions() & any_may_write) == fs::perms::none || access(target.path.c_str(), W_OK) != 0)
        complain(file, "a write-protected file", "a file that can be replaced",
                 "choose another path or change the permissions of the file");
    target.permissions = found.permissions();
    return target;
}

}  // namespace

void require_extension(const std::filesystem::path& file, std::initializer_list<std::string_view> extensions) {
    const std::string found = file.extension().string();
    if (std::ranges::find(extensions, found) != extensions.end()) return;
    std::string expected;
    for (const std::string_view extension : extensions)
        expected += (expected.empty() ? "" : " or ") + std::string(extension);
    complain(file, found.empty() ? "no extension" : "the extension " + found, expected, "choose another file name");
}

std::filesystem::path real_path(const std::filesystem::path& file) {
    std::error_code error;
    // If the file does not exist yet, weakly_canonical() keeps a relative name relative, so the name is first made
    // absolute.
    const std::filesystem::path full = std::filesystem::absolute(file);
    const std::filesystem::path found = std::filesystem::weakly_canonical(full, error);
    return error ? full : found;
}

void require_replaceable(const std::filesystem::path& file) {
    target_of(file);
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (std::filesystem::is_directory(folder)) return;
    complain(folder, error ? failure(error.message()) : "a file that is not a folder",
             "a folder that exists or can be created", "choose another path or check the permissions");
}

FileReplacement::FileReplacement(const std::filesystem::path& file) : file_(file), target_(target_of(file)) {
    if (target_.path.has_parent_path()) make_folder(target_.path.parent_path());
    part_ = target_.path;
    std::ios::openmode mode = std::ios::binary | std::ios::trunc | std::ios::out;
    if (!target_.takes_bytes) {
        part_ += ".part";
        mode |= std::ios::in;
    }
    errno = 0;
    stream_.open(part_, mode);
    if (!stream_)
        complain(file, failure(system_message(errno)), "a file that can be written",
                 "check the path and its permissions");
}

FileReplacement::~FileReplacement() {
    if (target_.takes_bytes) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

std::fstream& FileReplacement::seekable_stream() {
    if (target_.takes_bytes) complain(file_, "a pipe or a terminal", "a regular file", "choose another path");
    return stream_;
}

void FileReplacement::require_written() {
    if (!stream_.flush())
        complain(file_, failure(system_message(errno)) + " while writing", "enough space for the whole file",
                 "free disk space or choose another path");
}

void FileReplacement::commit() {
    require_written();
    stream_.close();
    if (target_.takes_bytes) return;
    std::error_code error;
    if (target_.permissions != std::filesystem::perms::unknown)
        std::filesystem::permissions(part_, target_.permissions, error);
    if (!error) std::filesystem::rename(part_, target_.path, error);
    if (error)
        complain(file_, failure(error.message()), "a file that can be replaced",
                 "check the permissions of the file and its folder");
}

void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write) {
    FileReplacement replacement(file);
    write(replacement.stream());
    replacement.commit();
}

}  // namespace skerry
