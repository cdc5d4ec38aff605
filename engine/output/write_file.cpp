#include "engine/output/write_file.h"

#include <cerrno>
#include <fstream>
#include <system_error>

#include "skerry/error.h"

namespace skerry {
namespace {

std::string what(int error) {
    return std::generic_category().message(error);
}

[[noreturn]] void complain(const std::filesystem::path& place, const std::string& found, const std::string& expected) {
    Complaint{.file = place.string(), .object = "output", .field = {}, .found = found, .expected = expected, .hint = {}}
        .raise();
}

/// Takes the unfinished file away again, also when its writer throws.
struct Temporary {
    std::filesystem::path path;

    ~Temporary() {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
    }
};

}  // namespace

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (std::filesystem::is_directory(folder)) return;
    complain(folder, error ? "\"" + error.message() + "\"" : "something that is no folder",
             "a folder that exists or can be made");
}

void write_file(const std::filesystem::path& file, FunctionRef<void(std::ostream&)> write) {
    if (file.has_parent_path()) make_folder(file.parent_path());
    const Temporary temporary{std::filesystem::path(file) += ".part"};
    errno = 0;
    std::ofstream out(temporary.path, std::ios::binary | std::ios::trunc);
    if (!out) complain(file, "\"" + what(errno) + "\"", "a file that can be written");
    write(out);
    out.close();
    if (!out) complain(file, "\"" + what(errno) + "\" while writing", "room for the whole file");
    std::error_code error;
    std::filesystem::rename(temporary.path, file, error);
    if (error) complain(file, "\"" + error.message() + "\"", "a file that can be replaced");
}

}  // namespace skerry
