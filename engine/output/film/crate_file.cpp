#include "engine/output/film/crate_file.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <iostream>

namespace skerry {

static_assert(std::endian::native == std::endian::little, "crate files store little-endian numbers");

namespace {

// Bit fields of a CrateValue, from the highest bit: flag "array"; flag "inlined"; type; payload. The payload is the
// value itself if it is inlined, else the position of the value in the file.
constexpr std::uint64_t array_bit = 1ull << 63, inlined_bit = 1ull << 62;
constexpr int type_shift = 48;
constexpr std::uint64_t payload_mask = (1ull << type_shift) - 1;

constexpr std::string_view header("PXR-USDC\0\x08\0\0\0\0\0\0", 16);  // identification, version 0.8.0 in 8 bytes
constexpr std::size_t header_reserved = 64;   // reserved zero bytes after the position of the table of contents
constexpr std::uint32_t end_of_fields = ~0u;  // ends each list of field indices in the table of field sets

/// Encodes bytes as an LZ4 block that consists only of literals, which means without compression. The zero byte at the
/// start is the number of further blocks, which the format expects there.
std::string literal_block(std::string_view bytes) {
    std::string out(1, '\0');
    constexpr std::size_t short_length = 15, long_step = 255;
    const std::size_t size = bytes.size();
    out += static_cast<char>(std::min(size, short_length) << 4);
    if (size >= short_length) {
        std::size_t rest = size - short_length;
        for (; rest >= long_step; rest -= long_step) out += static_cast<char>(long_step);
        out += static_cast<char>(rest);
    }
    return out.append(bytes);
}

std::string_view characters(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

/// The tables of specs, paths and fields. close() writes them at the end of the file.
struct CrateFile::Tables {
    std::vector<std::int32_t> field_token, field_sets;
    std::vector<CrateValue> field_value;
    std::vector<std::int32_t> spec_path, spec_fields, spec_kind;
    // Paths in depth-first order, with three values each:
    // - path_number: index of the path,
    // - path_token: token of its last element, negative for a property,
    // - path_jump: distance in this table to the next sibling. Special values are 0 (a next sibling, but no child), -1
    //   (a child, but no next sibling) and -2 (neither).
    std::vector<std::int32_t> path_number, path_token, path_jump;
};

CrateFile::CrateFile(std::iostream& file) : file_(file) {
    // The path table negates the token index of a property. Zero has no negative, so index 0 goes to the empty token,
    // which is the name of no property.
    token_index("");
    write(std::as_bytes(std::span(header)));
    write(std::vector<std::byte>(sizeof(std::int64_t) + header_reserved));
}

CrateValue CrateFile::inlined(CrateType type, std::uint32_t payload) {
    return static_cast<CrateValue>(inlined_bit | static_cast<std::uint64_t>(type) << type_shift | payload);
}

CrateValue CrateFile::stored(CrateType type, std::uint64_t position) {
    return static_cast<CrateValue>(static_cast<std::uint64_t>(type) << type_shift | position);
}

std::uint32_t CrateFile::token_index(std::string_view text) {
    const auto found = token_index_.find(text);
    if (found != token_index_.end()) return found->second;
    const auto index = static_cast<std::uint32_t>(tokens_.size());
    tokens_.emplace_back(text);
    token_index_.emplace(text, index);
    return index;
}

std::uint32_t CrateFile::path_index(const std::string& path) {
    return path_index_.try_emplace(path, static_cast<std::uint32_t>(path_index_.size())).first->second;
}

void CrateFile::write(std::span<const std::byte> bytes) {
    file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    size_ += bytes.size();
}

void CrateFile::align() {
    constexpr std::size_t alignment = 8;
    static constexpr std::byte zeros[alignment] = {};
    write(std::span(zeros).first((alignment - size_ % alignment) % alignment));
}

CrateValue CrateFile::string(std::string_view text) {
    strings_.push_back(token_index(text));
    return inlined(CrateType::string, static_cast<std::uint32_t>(strings_.size() - 1));
}

CrateValue CrateFile::float32(float value) {
    return inlined(CrateType::float32, std::bit_cast<std::uint32_t>(value));
}

CrateValue CrateFile::write_scalar(CrateType type, std::span<const std::byte> bytes) {
    align();
    const CrateValue value = stored(type, size_);
    write(bytes);
    return value;
}

CrateValue CrateFile::write_array(CrateType type, std::size_t count, std::span<const std::byte> bytes) {
    const auto array = [type](std::uint64_t position) {
        return static_cast<CrateValue>(array_bit | static_cast<std::uint64_t>(stored(type, position)));
    };
    if (count == 0) return array(0);
    align();
    const CrateValue value = array(size_);
    put(static_cast<std::uint64_t>(count));
    write(bytes);
    return value;
}

CrateValue CrateFile::token_array(std::span<const std::string> texts) {
    std::vector<std::uint32_t> indices;
    for (const std::string& text : texts) indices.push_back(token_index(text));
    return array(CrateType::token, std::span<const std::uint32_t>(indices));
}

void CrateFile::put_tokens(std::span<const std::string> texts) {
    put(static_cast<std::uint64_t>(texts.size()));
    for (const std::string& text : texts) put(token_index(text));
}

CrateValue CrateFile::token_vector(std::span<const std::string> texts) {
    align();
    const CrateValue value = stored(CrateType::token_vector, size_);
    put_tokens(texts);
    return value;
}

CrateValue CrateFile::prepended_token(std::string_view text) {
    const CrateValue value = stored(CrateType::token_list_op, size_);
    constexpr auto has_prepended = std::uint8_t{1 << 5};
    put(has_prepended);
    const std::string texts[] = {std::string(text)};
    put_tokens(texts);
    return value;
}

CrateValue CrateFile::target(std::string_view path) {
    const CrateValue value = stored(CrateType::path_list_op, size_);
    constexpr auto is_explicit_and_has_items = std::uint8_t{1 << 0 | 1 << 1};
    put(is_explicit_and_has_items);
    put(std::uint64_t{1});
    put(path_index(std::string(path)));
    return value;
}

CrateValue CrateFile::times(std::span<const double> times) {
    align();
    const CrateValue value = stored(CrateType::double_vector, size_);
    put(static_cast<std::uint64_t>(times.size()));
    write(std::as_bytes(times));
    return value;
}

CrateValue CrateFile::time_samples(CrateValue times, std::span<const CrateValue> values) {
    align();
    const CrateValue value = stored(CrateType::time_samples, size_);
    // An offset precedes the times, and another one the values. Each is the distance from itself to its entry, so that
    // data can stand between the two. Here the data are stored elsewhere, and an offset skips only its own 8 bytes.
    constexpr auto next = static_cast<std::int64_t>(sizeof(std::int64_t));
    put(next);
    put(times);
    put(next);
    put(static_cast<std::uint64_t>(values.size()));
    write(std::as_bytes(values));
    return value;
}

std::uint64_t CrateFile::begin_read(CrateValue array) {
    const std::uint64_t position = static_cast<std::uint64_t>(array) & payload_mask;
    if (position == 0) return 0;
    std::uint64_t count = 0;
    file_.seekg(static_cast<std::streamoff>(position));
    read(std::as_writable_bytes(std::span(&count, 1)));
    return count;
}

void CrateFile::read(std::span<std::byte> bytes) {
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void CrateFile::end_read() {
    file_.seekp(0, std::ios::end);
}

void CrateFile::put_packed(std::string_view bytes) {
    const std::string block = literal_block(bytes);
    put(static_cast<std::uint64_t>(block.size()));
    write(std::as_bytes(std::span(block)));
}

/// Writes integers in the coding of the format: the most common difference of neighbours, a code of two bits for the
/// size of each difference, and the differences. Here the most common difference is not used (0), and all differences
/// have 32 bits (code 3).
void CrateFile::put_integers(std::span<const std::int32_t> values) {
    constexpr std::size_t codes_per_byte = 4;
    std::string bytes(sizeof(std::int32_t), '\0');
    bytes.append((values.size() + codes_per_byte - 1) / codes_per_byte, '\xff');
    std::uint32_t prev = 0;
    for (const std::int32_t value : values) {
        const std::uint32_t difference = static_cast<std::uint32_t>(value) - prev;
        bytes.append(characters(std::as_bytes(std::span(&difference, 1))));
        prev = static_cast<std::uint32_t>(value);
    }
    put_packed(bytes);
}

/// Adds to a spec and to all specs below it the fields that list the names of their properties and prims.
void CrateFile::list_children(CrateSpec& spec) {
    std::vector<std::string> properties, prims;
    for (CrateSpec& child : spec.children) {
        (child.kind == SpecKind::prim ? prims : properties).push_back(child.name);
        list_children(child);
    }
    if (!properties.empty()) spec.fields.emplace_back("properties", token_vector(properties));
    if (!prims.empty()) spec.fields.emplace_back("primChildren", token_vector(prims));
}

void CrateFile::collect(const CrateSpec& spec, const std::string& path, bool has_sibling, Tables& tables) {
    const auto number = static_cast<std::int32_t>(path_index(path));
    const bool is_property = spec.kind == SpecKind::attribute || spec.kind == SpecKind::relationship;
    const auto name = static_cast<std::int32_t>(token_index(spec.name));
    tables.spec_path.push_back(number);
    tables.spec_fields.push_back(static_cast<std::int32_t>(tables.field_sets.size()));
    tables.spec_kind.push_back(static_cast<std::int32_t>(spec.kind));
    for (const auto& [field, value] : spec.fields) {
        tables.field_sets.push_back(static_cast<std::int32_t>(tables.field_token.size()));
        tables.field_token.push_back(static_cast<std::int32_t>(token_index(field)));
        tables.field_value.push_back(value);
    }
    tables.field_sets.push_back(static_cast<std::int32_t>(end_of_fields));
    const std::size_t row = tables.path_number.size();
    tables.path_number.push_back(number);
    tables.path_token.push_back(is_property ? -name : name);
    tables.path_jump.push_back(has_sibling ? 0 : -2);
    if (spec.children.empty()) return;
    for (const CrateSpec& child : spec.children) {
        const char* separator = child.kind != SpecKind::prim ? "." : spec.kind == SpecKind::root ? "" : "/";
        collect(child, path + separator + child.name, &child != &spec.children.back(), tables);
    }
    tables.path_jump[row] = has_sibling ? static_cast<std::int32_t>(tables.path_number.size() - row) : -1;
}

void CrateFile::close(CrateSpec root) {
    list_children(root);
    Tables tables;
    collect(root, "/", false, tables);

    struct Section {
        char name[16] = {};
        std::uint64_t start, size;
    };
    std::vector<Section> sections;
    const auto section = [&](std::string_view name, const std::function<void()>& put_content) {
        Section& added = sections.emplace_back();
        name.copy(added.name, name.size());
        added.start = size_;
        put_content();
        added.size = size_ - added.start;
    };
    const auto put_size = [this](std::size_t size) { put(static_cast<std::uint64_t>(size)); };
    section("TOKENS", [&] {
        std::string text;
        for (const std::string& token : tokens_) text.append(token).append(1, '\0');
        put_size(tokens_.size());
        put_size(text.size());
        put_packed(text);
    });
    section("STRINGS", [&] {
        put_size(strings_.size());
        write(std::as_bytes(std::span(strings_)));
    });
    section("FIELDS", [&] {
        put_size(tables.field_token.size());
        put_integers(tables.field_token);
        put_packed(characters(std::as_bytes(std::span(tables.field_value))));
    });
    section("FIELDSETS", [&] {
        put_size(tables.field_sets.size());
        put_integers(tables.field_sets);
    });
    section("PATHS", [&] {
        put_size(path_index_.size());
        put_size(tables.path_number.size());
        put_integers(tables.path_number);
        put_integers(tables.path_token);
        put_integers(tables.path_jump);
    });
    section("SPECS", [&] {
        put_size(tables.spec_path.size());
        put_integers(tables.spec_path);
        put_integers(tables.spec_fields);
        put_integers(tables.spec_kind);
    });
    const auto contents = static_cast<std::int64_t>(size_);
    put_size(sections.size());
    write(std::as_bytes(std::span(sections)));
    file_.seekp(static_cast<std::streamoff>(header.size()));
    put(contents);
}

}  // namespace skerry
