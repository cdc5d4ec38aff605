// The bytes of a saved world: named arrays in the safetensors format, which other programs can read as well. The length
// of the header (8 bytes) is followed by the header (a JSON text) and by the arrays, without gaps between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/row_type.h"

namespace skerry {

inline constexpr int world_file_version = 30;

/// Texts in the header of a saved world.
struct SavedTexts {
    std::string state_hash;  // checksum_text() of the hash of the world
    std::string note;        // text of the caller; bytes that are not UTF-8 are saved as \u00XX
};

/// An array that is to be saved: rows of `width` numbers each.
struct ArraySource {
    std::string name;
    NumberType number;
    std::size_t rows, width;
    const std::byte* first;  // address of the first row
    std::size_t stride;      // distance between two rows [bytes]
};

/// Returns the bytes of a saved world. Arrays whose numbers have the most bytes come first, so that all numbers are
/// aligned.
std::vector<std::byte> saved_bytes(std::vector<ArraySource> arrays, const SavedTexts& texts);

/// Writes the checksum of the present bytes into the header of a saved world. Tests need it after they have changed
/// bytes.
void renew_checksum(std::span<std::byte> file);

/// An array in a saved world: rows of `width` numbers each.
struct SavedArray {
    NumberType number;
    std::size_t rows, width;
    std::span<const std::byte> bytes;

    std::size_t row_bytes() const { return width * bytes_of(number); }
};

/// A saved world whose checksum and header are right. The values of the arrays are not checked.
class SavedFile {
public:
    /// Throws SceneError if the bytes are not those of an undamaged saved world of the present version. Messages use
    /// `name` in place of a file name. The bytes must outlive this object.
    SavedFile(std::string name, std::span<const std::byte> bytes);

    const std::map<std::string, SavedArray>& arrays() const { return arrays_; }
    const SavedTexts& texts() const { return texts_; }
    /// Throws SceneError about an array. `path` is the name of the array.
    [[noreturn]] void complain(const std::string& path, const std::string& found, const std::string& expected) const;

private:
    std::string name_;
    std::map<std::string, SavedArray> arrays_;
    SavedTexts texts_;
};

/// Number of bytes from the start of a file that require_file_start() needs. A shorter file is passed completely.
inline constexpr std::size_t start_bytes = 512;
/// Checks the first bytes of a file of `size` bytes. Throws SceneError unless they belong to a saved world of the
/// present version and of this size.
void require_file_start(const std::string& name, std::span<const std::byte> start, std::uint64_t size);

/// Throws SceneError about a file that is not a saved world of the present version. If `expected` is empty, the message
/// names a saved world of the present version as the expected file.
[[noreturn]] void refuse_file(const std::string& name, const std::string& found, const std::string& hint,
                              const std::string& expected = {});

/// Returns the hash as 16 hexadecimal digits.
std::string checksum_text(std::uint64_t hash);

/// Copies rows of `row_bytes` bytes. Strides are distances between two rows [bytes].
void copy_strided(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
                  std::size_t row_bytes, std::size_t rows);

}  // namespace skerry
