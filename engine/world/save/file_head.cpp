#include "engine/world/save/file_head.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <vector>

#include "components/hash.h"
#include "skerry/error.h"

namespace skerry {

namespace {

constexpr const char* title = "Skerry world, version ";

std::string expected_file() {
    return "a world that Skerry saved, version " + std::to_string(world_file_version);
}

[[noreturn]] void refuse_file(const std::filesystem::path& file, const std::string& found, const std::string& expected,
                              const std::string& hint = {}) {
    Complaint{.file = file.string(), .object = {}, .field = {}, .found = found, .expected = expected, .hint = hint}
        .raise();
}

std::string text_of(std::uint64_t bytes, std::uint64_t hash) {
    char text[head_bytes] = {};
    std::snprintf(text, sizeof text,
                  "%s%d\nAn HDF5 file of %" PRIu64 " bytes begins at byte %zu.\nXXH3 of these bytes: %016" PRIx64 "\n",
                  title, world_file_version, bytes, head_bytes, hash);
    return std::string(text, sizeof text);
}

}  // namespace

std::string head_of(std::span<const char> body) {
    Hash hash;
    hash.add(body.data(), body.size());
    return text_of(body.size(), hash.value());
}

void check_head(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) refuse_file(file, "no such file", expected_file(), "check the path");
    if (!std::filesystem::is_regular_file(status))
        refuse_file(file, "a folder or device", expected_file(), "check the path");
    std::ifstream in(file, std::ios::binary);
    if (!in)
        refuse_file(file, "a file that cannot be opened or read", expected_file(), "check the permissions of the file");
    std::string head(head_bytes, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(in.gcount()));
    if (!head.starts_with(title)) refuse_file(file, "a file of another kind", expected_file(), "check the path");
    int version = 0;
    std::uint64_t bytes = 0;
    const std::string behind_title = head.substr(std::string(title).size());
    if (std::sscanf(behind_title.c_str(), "%d", &version) == 1 && version != world_file_version)
        refuse_file(file, "version " + std::to_string(version), "version " + std::to_string(world_file_version),
                    "another version of Skerry wrote the file; load the file with that version");
    const std::size_t second_line = head.find('\n');
    if (head.size() != head_bytes || second_line == std::string::npos ||
        std::sscanf(head.c_str() + second_line + 1, "An HDF5 file of %" SCNu64, &bytes) != 1)
        refuse_file(file, "a damaged header", expected_file(), "save the world again");
    const std::uint64_t size = std::filesystem::file_size(file, error);
    if (error || size != head_bytes + bytes)
        refuse_file(file, std::to_string(size) + " bytes",
                    std::to_string(head_bytes + bytes) + " bytes, as the header announces",
                    size < head_bytes + bytes ? "the end of the file is missing; copy or save the file again"
                                              : "the file has extra bytes at its end; copy or save the file again");

    Hash hash;
    std::vector<char> part(1 << 20);
    for (std::uint64_t left = bytes; left > 0;) {
        const auto count = static_cast<std::streamsize>(std::min<std::uint64_t>(left, part.size()));
        in.read(part.data(), count);
        if (in.gcount() != count)
            refuse_file(file, "bytes that cannot be read", expected_file(), "check the disk, or save the world again");
        hash.add(part.data(), static_cast<std::size_t>(count));
        left -= static_cast<std::uint64_t>(count);
    }
    if (head != text_of(bytes, hash.value()))
        refuse_file(file, "bytes that do not match the checksum in the header", "the bytes that Skerry saved",
                    "the file is damaged; save the world again");
}

}  // namespace skerry
