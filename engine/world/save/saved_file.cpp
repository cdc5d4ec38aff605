#include "engine/world/save/saved_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

#include "components/hash.h"
#include "engine/base/complaint.h"

namespace skerry {

namespace {

// size of the first number in a file, which is the length of the header [bytes]
constexpr std::size_t length_bytes = sizeof(std::uint64_t);
constexpr std::size_t checksum_digits = 16;
constexpr std::string_view file_title = "Skerry world, version ";
constexpr std::string_view metadata = "__metadata__";
// names of the number types in the header, in the order of NumberType
constexpr std::array<std::string_view, 7> type_names{"F64", "F32", "I32", "U8", "U16", "U32", "U64"};

/// Returns the start of the header. The checksum follows, so its position does not depend on the contents of the file.
const std::string& header_opening() {
    static const std::string text = "{\"" + std::string(metadata) + "\":{\"format\":\"" + std::string(file_title) +
                                    std::to_string(world_file_version) + "\",\"checksum\":\"";
    return text;
}
constexpr std::string_view behind_checksum = "\",\"data_bytes\":\"";

std::size_t checksum_begin() {
    return length_bytes + header_opening().size();
}

std::string_view text_in(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the checksum of all bytes except those of the checksum itself.
std::string checksum_of(std::span<const std::byte> file) {
    const std::size_t end = checksum_begin() + checksum_digits;
    Hash hash;
    hash.add(file.data(), checksum_begin());
    hash.add(file.data() + end, file.size() - end);
    return checksum_text(hash.value());
}

std::uint64_t header_length(std::span<const std::byte> start) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < length_bytes; ++i) length |= std::to_integer<std::uint64_t>(start[i]) << (8 * i);
    return length;
}

/// Length of the UTF-8 character with which a text begins; 0 if it does not begin with one [bytes].
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
    for (std::size_t i = 1; i < length; ++i)
        if (byte(i) < 0x80 || byte(i) >= 0xc0) return 0;
    // refused: characters encoded with more bytes than needed, surrogates, and numbers above U+10FFFF
    const bool refused = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) >= 0xa0) ||
                         (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90);
    return refused ? 0 : length;
}

/// Returns a text as JSON, without quotation marks. Control characters, and bytes that are not UTF-8, become \u00XX.
std::string in_json(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const auto c = static_cast<unsigned char>(text[0]);
        const std::size_t length = utf8_length(text);
        if (c < ' ' || length == 0) {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
            result += code;
        } else {
            if (c == '"' || c == '\\') result += '\\';
            result += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return result;
}

/// Reads a header from its start to its end. Accepts only the subset of JSON in which saved_bytes() writes a header.
class HeaderReader {
public:
    HeaderReader(const std::string& file, std::string_view text) : file_(file), text_(text) {}

    bool take(std::string_view expected) {
        if (!text_.substr(at_).starts_with(expected)) return false;
        at_ += expected.size();
        return true;
    }
    void require(std::string_view expected) {
        if (!take(expected)) refuse(std::string(expected));
    }
    std::uint64_t integer() {
        std::uint64_t value = 0;
        const char* const begin = text_.data() + at_;
        const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
        if (error != std::errc() || (*begin == '0' && end - begin > 1)) refuse("an integer");
        at_ += static_cast<std::size_t>(end - begin);
        return value;
    }
    /// Reads the rest of a text and the quotation mark behind it.
    std::string text() {
        std::string result;
        while (!take("\"")) {
            if (take("\\u00")) {
                unsigned code = 0;
                const char* const begin = text_.data() + at_;
                const char* const end = begin + std::min<std::size_t>(2, text_.size() - at_);
                if (std::from_chars(begin, end, code, 16).ptr != begin + 2 || (code >= ' ' && code < 0x80))
                    refuse("a control character, or a byte that is not UTF-8");
                at_ += 2;
                result += static_cast<char>(code);
                continue;
            }
            if (take("\\") && !text_.substr(at_).starts_with("\"") && !text_.substr(at_).starts_with("\\"))
                refuse("a quotation mark or a backslash");
            if (at_ == text_.size() || static_cast<unsigned char>(text_[at_]) < ' ') refuse("the end of a text");
            result += text_[at_++];
        }
        return result;
    }
    void require_padding() {
        if (text_.find_first_not_of(' ', at_) != std::string_view::npos || text_.size() - at_ >= length_bytes)
            refuse("at most 7 spaces");
    }
    [[noreturn]] void refuse(const std::string& expected) const {
        refuse_in(file_, "header", {}, "other text at byte " + std::to_string(length_bytes + at_), expected,
                  "the file was not written by Skerry; save the world again");
    }

private:
    const std::string& file_;
    std::string_view text_;
    std::size_t at_ = 0;
};

/// Reads the entry of an array after its name. `begin` is the end of the previous array in `data`.
SavedArray array_in(HeaderReader& header, std::span<const std::byte> data, std::size_t begin) {
    header.require("{\"dtype\":\"");
    const std::string type = header.text();
    const auto named = std::ranges::find(type_names, type);
    if (named == type_names.end()) header.refuse("one of the types F64, F32, I32, U8, U16, U32, U64");
    SavedArray array{.number = static_cast<NumberType>(named - type_names.begin()), .rows = 0, .width = 1, .bytes = {}};
    constexpr std::uint64_t most = std::numeric_limits<std::int32_t>::max();
    header.require(",\"shape\":[");
    const std::uint64_t rows = header.integer();
    const std::uint64_t width = header.take(",") ? header.integer() : 1;
    if (rows > most || width > most || width == 0) header.refuse("a shape of at most 2147483647 rows and columns");
    array.rows = rows;
    array.width = width;
    header.require("],\"data_offsets\":[" + std::to_string(begin) + ",");
    const std::uint64_t end = header.integer();
    if (end < begin || end > data.size() || (end - begin) % array.row_bytes() != 0 ||
        (end - begin) / array.row_bytes() != rows)
        header.refuse("the end of an array with this shape, within the file");
    header.require("]}");
    array.bytes = data.subspan(begin, end - begin);
    return array;
}

}  // namespace

std::string checksum_text(std::uint64_t hash) {
    char text[checksum_digits + 1];
    std::snprintf(text, sizeof text, "%016" PRIx64, hash);
    return text;
}

void copy_strided(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
                  std::size_t row_bytes, std::size_t rows) {
    if (rows == 0) return;
    if (from_stride == row_bytes && to_stride == row_bytes) {
        std::memcpy(to, from, rows * row_bytes);
        return;
    }
    for (std::size_t row = 0; row < rows; ++row) std::memcpy(to + row * to_stride, from + row * from_stride, row_bytes);
}

void refuse_file(const std::string& name, const std::string& found, const std::string& hint,
                 const std::string& expected) {
    const std::string usual = "a world that Skerry saved, version " + std::to_string(world_file_version);
    refuse_in(name, {}, {}, found, expected.empty() ? usual : expected, hint);
}

std::vector<std::byte> saved_bytes(std::vector<ArraySource> arrays, const SavedTexts& texts) {
    std::ranges::stable_sort(arrays, std::greater(), [](const ArraySource& array) { return bytes_of(array.number); });
    const auto size_of = [](const ArraySource& array) { return array.rows * array.width * bytes_of(array.number); };
    std::size_t data_bytes = 0;
    for (const ArraySource& array : arrays) data_bytes += size_of(array);
    std::string header = header_opening() + std::string(checksum_digits, '0') + std::string(behind_checksum) +
                         std::to_string(data_bytes) + "\",\"state_hash\":\"" + in_json(texts.state_hash) +
                         "\",\"note\":\"" + in_json(texts.note) + "\"}";
    std::size_t end = 0;
    for (const ArraySource& array : arrays) {
        const std::size_t begin = end;
        end += size_of(array);
        header += ",\"" + in_json(array.name) + "\":{\"dtype\":\"" +
                  std::string(type_names[static_cast<std::size_t>(array.number)]) + "\",\"shape\":[" +
                  std::to_string(array.rows) + (array.width == 1 ? "" : "," + std::to_string(array.width)) +
                  "],\"data_offsets\":[" + std::to_string(begin) + "," + std::to_string(end) + "]}";
    }
    header += "}";
    header.append((length_bytes - header.size() % length_bytes) % length_bytes, ' ');

    std::vector<std::byte> file(length_bytes + header.size() + data_bytes);
    for (std::size_t i = 0; i < length_bytes; ++i) file[i] = static_cast<std::byte>(header.size() >> (8 * i) & 0xff);
    std::memcpy(file.data() + length_bytes, header.data(), header.size());
    std::byte* to = file.data() + length_bytes + header.size();
    for (const ArraySource& array : arrays) {
        const std::size_t row_bytes = array.width * bytes_of(array.number);
        copy_strided(array.first, array.stride, to, row_bytes, row_bytes, array.rows);
        to += size_of(array);
    }
    renew_checksum(file);
    return file;
}

void renew_checksum(std::span<std::byte> file) {
    const std::string checksum = checksum_of(file);
    std::memcpy(file.data() + checksum_begin(), checksum.data(), checksum.size());
}

void require_file_start(const std::string& name, std::span<const std::byte> start, std::uint64_t size) {
    const std::string_view text = text_in(start);
    // Largest number of bytes before the title. Files of versions before 25 begin with the title.
    constexpr std::size_t most_before_title = 64;
    const std::size_t at = text.substr(0, most_before_title).find(file_title);
    if (at == std::string_view::npos) refuse_file(name, "a file of another kind", "check the path");
    int version = 0;
    const char* const digits = text.data() + at + file_title.size();
    if (std::from_chars(digits, text.data() + text.size(), version).ec == std::errc() && version != world_file_version)
        refuse_file(name, "version " + std::to_string(version),
                    "another version of Skerry wrote the file; load the file with that version",
                    "version " + std::to_string(world_file_version));
    const std::size_t end = checksum_begin() + checksum_digits;
    const std::string_view behind = text.substr(std::min(end, text.size()));
    std::uint64_t data_bytes = 0;
    // largest length accepted; the sum of the three lengths below then does not overflow
    constexpr std::uint64_t most = std::uint64_t{1} << 62;
    if (!text.substr(length_bytes).starts_with(header_opening()) || !behind.starts_with(behind_checksum) ||
        std::from_chars(behind.data() + behind_checksum.size(), text.data() + text.size(), data_bytes).ec !=
            std::errc() ||
        header_length(start) > most || data_bytes > most)
        refuse_file(name, "a damaged header", "save the world again");
    const std::uint64_t expected = length_bytes + header_length(start) + data_bytes;
    if (size != expected)
        refuse_file(name, std::to_string(size) + " bytes",
                    size < expected ? "the end of the file is missing; copy or save the file again"
                                    : "the file has extra bytes at its end; copy or save the file again",
                    std::to_string(expected) + " bytes, as the header announces");
}

SavedFile::SavedFile(std::string name, std::span<const std::byte> bytes) : name_(std::move(name)) {
    require_file_start(name_, bytes.first(std::min(start_bytes, bytes.size())), bytes.size());
    const std::string checksum = checksum_of(bytes);
    if (text_in(bytes).substr(checksum_begin(), checksum_digits) != checksum)
        refuse_file(name_, "bytes that do not match the checksum in the header",
                    "the file is damaged; save the world again", "the bytes that Skerry saved");
    const auto length = static_cast<std::size_t>(header_length(bytes));
    const std::span<const std::byte> data = bytes.subspan(length_bytes + length);
    HeaderReader header(name_, text_in(bytes.subspan(length_bytes, length)));
    header.require(header_opening() + checksum + std::string(behind_checksum) + std::to_string(data.size()) +
                   "\",\"state_hash\":\"");
    texts_.state_hash = header.text();
    header.require(",\"note\":\"");
    texts_.note = header.text();
    header.require("}");
    std::size_t end = 0;
    while (header.take(",\"")) {
        const std::string array = header.text();
        header.require(":");
        if (array == metadata || arrays_.contains(array)) header.refuse("an array with another name");
        end += arrays_.emplace(array, array_in(header, data, end)).first->second.bytes.size();
    }
    header.require("}");
    header.require_padding();
    if (end != data.size()) header.refuse("arrays that fill the file");
}

void SavedFile::complain(const std::string& path, const std::string& found, const std::string& expected) const {
    const std::size_t slash = path.rfind('/');
    const bool in_group = slash != std::string::npos;
    refuse_in(name_, in_group ? path.substr(0, slash) : std::string(), in_group ? path.substr(slash + 1) : path, found,
              expected, "the file is damaged or was edited; save the world again");
}

}  // namespace skerry
