#include "engine/mesh/formats/file_reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "engine/base/complaint.h"

namespace skerry::mesh {
namespace {

constexpr const char* incomplete = "the file is incomplete; copy or export it again";

}  // namespace

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::string in_lower_case(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return lower;
}

std::string in_upper_case(std::string_view text) {
    std::string upper(text);
    std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return upper;
}

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 60;
    std::string shown = "\"";
    for (const char c : text.substr(0, longest)) shown += (c >= ' ' && c <= '~') ? c : '?';
    return shown + (text.size() > longest ? "...\"" : "\"");
}

FileReader::FileReader(const std::string& path) : path_(path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) refuse_in(path, {}, {}, "no such file", "a mesh file", "check the path");
    if (!std::filesystem::is_regular_file(path, error))
        refuse_in(path, {}, {}, "a folder or device", "a mesh file", "check the path");
    std::ifstream file(path, std::ios::binary);
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (file && !error) {
        data_.resize(static_cast<std::size_t>(size));
        file.read(data_.data(), static_cast<std::streamsize>(data_.size()));
    }
    if (!file || error)
        refuse_in(path, {}, {}, "a file that cannot be opened or read", "a mesh file",
                  "check the permissions of the file");
}

void FileReader::set_row(const char* kind, std::size_t number, std::size_t count) {
    row_kind_ = kind;
    row_number_ = number;
    row_count_ = count;
}

bool FileReader::at_end() const {
    return peek_word().empty();
}

std::string_view FileReader::line() {
    last_was_binary_ = false;
    start_ = position_;
    const std::size_t end = std::min(data_.find('\n', position_), data_.size());
    position_ = std::min(end + 1, data_.size());
    return trimmed(std::string_view(data_).substr(start_, end - start_));
}

std::string_view FileReader::filled_line(const char* expected) {
    while (position_ < data_.size()) {
        const std::string_view text = line();
        if (!text.empty()) return text;
    }
    start_ = data_.size();
    last_was_binary_ = false;
    complain({}, "the end of the file", expected, incomplete);
}

const std::vector<std::string_view>& FileReader::words_of(std::string_view text) {
    words_.clear();
    for (std::size_t i = 0; i < text.size();) {
        while (i < text.size() && is_space(text[i])) ++i;
        const std::size_t begin = i;
        while (i < text.size() && !is_space(text[i])) ++i;
        if (i > begin) words_.push_back(text.substr(begin, i - begin));
    }
    return words_;
}

std::string_view FileReader::peek_word() const {
    std::size_t begin = position_;
    while (begin < data_.size() && is_space(data_[begin])) ++begin;
    std::size_t end = begin;
    while (end < data_.size() && !is_space(data_[end])) ++end;
    return std::string_view(data_).substr(begin, end - begin);
}

std::string_view FileReader::word(const char* expected) {
    const std::string_view text = peek_word();
    last_was_binary_ = false;
    start_ = static_cast<std::size_t>(text.data() - data_.data());
    if (text.empty()) complain({}, "the end of the file", expected, incomplete);
    position_ = start_ + text.size();
    return text;
}

Real FileReader::parse_real(std::string_view text, const char* field) const {
    std::string_view digits = text;
    // std::from_chars does not accept a plus sign before a number.
    if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
    Real value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
        complain(field, in_quotes(text), "a number");
    // std::from_chars leaves `value` unchanged if the number is out of range. std::strtod gives zero or a subnormal
    // number if it is too small, and infinity if it is too large.
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
    return value;
}

std::int64_t FileReader::parse_integer(std::string_view text, const char* field) const {
    std::string_view digits = text;
    if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size()) complain(field, in_quotes(text), "an integer");
    return value;
}

void FileReader::begin_binary(std::size_t size, const char* field) {
    last_was_binary_ = true;
    start_ = position_;
    if (size > remaining()) complain(field, "the end of the file", std::to_string(size) + " more bytes", incomplete);
}

Real FileReader::real(const NumberType& type, const char* field) {
    if (!binary_) return parse_real(word(field), field);
    if (type.kind == NumberKind::float32) return static_cast<Real>(binary<float>(field));
    if (type.kind == NumberKind::float64) return binary<double>(field);
    return static_cast<Real>(integer(type, field));
}

std::int64_t FileReader::integer(const NumberType& type, const char* field) {
    if (!binary_) return parse_integer(word(field), field);
    switch (type.kind) {
        case NumberKind::int8:
            return binary<std::int8_t>(field);
        case NumberKind::uint8:
            return binary<std::uint8_t>(field);
        case NumberKind::int16:
            return binary<std::int16_t>(field);
        case NumberKind::uint16:
            return binary<std::uint16_t>(field);
        case NumberKind::int32:
            return binary<std::int32_t>(field);
        case NumberKind::uint32:
            return binary<std::uint32_t>(field);
        case NumberKind::int64:
            return binary<std::int64_t>(field);
        case NumberKind::uint64:
            return static_cast<std::int64_t>(binary<std::uint64_t>(field));
        default:
            complain(field, "a floating-point type", "an integer type");
    }
}

void FileReader::skip_bytes(std::size_t count, const char* field) {
    begin_binary(count, field);
    position_ += count;
}

bool FileReader::skip_behind(std::string_view mark) {
    for (std::size_t at = data_.find(mark, position_); at != std::string::npos; at = data_.find(mark, at + 1)) {
        const std::size_t end = at + mark.size();
        if (end < data_.size() && !is_space(data_[end])) continue;
        position_ = end;
        return true;
    }
    return false;
}

std::size_t FileReader::checked_count(std::int64_t count, std::size_t bytes, const char* field) const {
    if (count < 0) complain(field, std::to_string(count), "a count >= 0");
    // The last row needs no line end at the end of the file, so one more row may fit than the bytes suggest.
    const std::size_t fits = remaining() / bytes + 1;
    if (static_cast<std::uint64_t>(count) > fits)
        complain(field, std::to_string(count), "at most " + std::to_string(fits),
                 "only " + std::to_string(remaining()) +
                     " bytes of the file are left; correct this count or export the file again");
    if (count > 0x7fffffff / 4)
        complain(field, std::to_string(count), "at most " + std::to_string(0x7fffffff / 4),
                 "indices have 32 bits; use a coarser mesh");
    return static_cast<std::size_t>(count);
}

Real FileReader::finite(Real value, const char* field) const {
    if (!std::isfinite(value))
        complain(field, std::isnan(value) ? "nan" : "an infinite or too large number", "a finite number");
    return value;
}

std::string FileReader::place() const {
    if (last_was_binary_) return "byte " + std::to_string(start_);
    const auto lines =
        std::count(data_.begin(), data_.begin() + static_cast<std::ptrdiff_t>(std::min(start_, data_.size())), '\n');
    return "line " + std::to_string(lines + 1);
}

void FileReader::complain(std::string field, std::string found, std::string expected, std::string hint) const {
    std::string object = section_.empty() ? std::string() : section_ + ", ";
    if (row_kind_ != nullptr)
        object += row_kind_ + (" " + std::to_string(row_number_)) + " of " + std::to_string(row_count_) + ", ";
    refuse_in(path_, object + place(), field, found, expected, hint);
}

}  // namespace skerry::mesh
