#include "engine/base/separate_outputs.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"

namespace skerry {

namespace {

/// Description of this process for the users of other processes.
std::string text_of_process(std::string_view user) {
    std::array<char, 256> host{};
    gethostname(host.data(), host.size() - 1);
    return "process " + std::to_string(getpid()) + " on " + host.data() + " (" + std::string(user) + ")";
}

// Start of the content of each lock. A file of this name with another content belongs to a user.
constexpr std::string_view lock_mark = "Skerry lock: ";

/// Returns the start of the content of an open file, enough for the content of a lock.
std::string content_of(int descriptor) {
    std::array<char, 4096> text{};
    const auto size = pread(descriptor, text.data(), text.size(), 0);
    return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

/// True if the open file can be a lock: a regular file that is empty or begins with lock_mark.
bool can_be_lock(int descriptor, const std::string& content) {
    struct stat file;
    return fstat(descriptor, &file) == 0 && S_ISREG(file.st_mode) &&
           (content.empty() || content.starts_with(lock_mark));
}

void write_lock(int descriptor, const std::string& content) {
    // The content only serves messages of other processes, so a failure changes nothing.
    if (ftruncate(descriptor, 0) != 0) return;
    [[maybe_unused]] const auto written = pwrite(descriptor, content.data(), content.size(), 0);
}

/// True if the path still leads to the open file. Another process may have removed the file before it was locked.
bool is_at(const std::filesystem::path& path, int descriptor) {
    struct stat open_file, found;
    return fstat(descriptor, &open_file) == 0 && stat(path.c_str(), &found) == 0 && open_file.st_ino == found.st_ino &&
           open_file.st_dev == found.st_dev;
}

}  // namespace

OutputLock::OutputLock(const std::filesystem::path& lock_file, Complaint output, std::string_view user)
    : file_(lock_file) {
    if (file_.empty()) return;
    if (file_.has_parent_path()) make_folder(file_.parent_path());
    do {
        if (descriptor_ >= 0) close(descriptor_);
        descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor_ < 0) {
            output.found =
                "the error \"" + std::generic_category().message(errno) + "\" for the lock " + file_.string();
            output.expected = "a folder with write permission";
            output.raise();
        }
        const std::string content = content_of(descriptor_);
        if (!can_be_lock(descriptor_, content)) {
            close(descriptor_);
            output.found = "the file " + file_.string() + ", which is not a lock of Skerry";
            output.expected = "no other file with the name of the lock";
            output.hint = "rename that file, or choose another path for the output";
            output.raise();
        }
        if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            close(descriptor_);
            output.found = "an output of " + (content.empty() ? "another process" : content.substr(lock_mark.size()));
            output.expected = "an output of one process at a time";
            output.hint = "wait until that process has ended, or choose another path";
            throw OutputReserved(output);
        }
    } while (!is_at(file_, descriptor_));
    write_lock(descriptor_, std::string(lock_mark) + text_of_process(user));
}

OutputLock::~OutputLock() {
    if (descriptor_ < 0) return;
    // The file is removed while it is still locked, so that is_at() finds the removal. A file that another process has
    // put in its place stays.
    std::error_code ignored;
    if (is_at(file_, descriptor_)) std::filesystem::remove(file_, ignored);
    close(descriptor_);
}

EarlierFiles::EarlierFiles(const std::filesystem::path& folder, FunctionRef<bool(const std::string& name)> is_own) {
    std::error_code error;
    std::filesystem::directory_iterator entries(folder, error);
    if (error && error != std::errc::no_such_file_or_directory)
        refuse_in(folder.string(), "output", {}, "the error \"" + error.message() + "\" while listing this folder",
                  "a folder with read permission", "check the permissions of the folder, or choose another folder");
    for (const auto& entry : entries)
        if (entry.symlink_status().type() == std::filesystem::file_type::regular &&
            is_own(entry.path().filename().string()))
            files_.push_back(entry.path());
    std::ranges::sort(files_);
    for (const std::filesystem::path& file : files_) require_replaceable(file);
}

void EarlierFiles::remove() {
    for (const std::filesystem::path& file : std::exchange(files_, {})) {
        std::error_code error;
        std::filesystem::remove(file, error);
        if (error)
            refuse_in(file.string(), "output", {},
                      "the error \"" + error.message() + "\" while removing this file of an earlier run",
                      "a file that can be replaced", "check the permissions of the folder, or choose another folder");
    }
}

}  // namespace skerry
