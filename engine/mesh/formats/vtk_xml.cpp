#include "engine/mesh/formats/vtk_xml.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>

#include "engine/mesh/formats/inflate.h"

namespace skerry::mesh {
namespace {

constexpr const char* damaged = "the file is damaged or incomplete; export it again";

/// Returns the byte offset of the first `text` at or after the offset `begin`. Throws SceneError if there is none.
std::size_t place_of(std::string_view text, std::size_t begin, FileReader& reader) {
    const std::size_t found = bytes_of(reader).find(text, begin);
    if (found != std::string_view::npos) return found;
    reader.go_to(begin);
    reader.complain({}, "no " + in_quotes(text) + " in the rest of the file", std::string(text), damaged);
}

/// Reads the attributes name="value" of a tag. `text` is the part of the tag after its name.
void read_attributes(std::string_view text, XmlTag& tag, const FileReader& reader) {
    while (true) {
        while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
        if (text.empty()) return;
        const std::size_t equals = text.find('=');
        std::string_view name = text.substr(0, equals);
        while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
        std::size_t begin = equals == std::string_view::npos ? text.size() : equals + 1;
        while (begin < text.size() && is_space(text[begin])) ++begin;
        const std::size_t end = begin < text.size() ? text.find(text[begin], begin + 1) : std::string_view::npos;
        if (end == std::string_view::npos || name.empty() || (text[begin] != '"' && text[begin] != '\''))
            reader.complain("attributes of <" + std::string(tag.name) + ">", in_quotes(text), "name=\"value\"",
                            damaged);
        tag.attributes.emplace_back(name, text.substr(begin + 1, end - begin - 1));
        text.remove_prefix(end + 1);
    }
}

/// Returns the bytes of an array piece by piece. In the file they are raw or encoded in base64. Base64 may have padding
/// also before its end, because some programs encode the header of an array separately.
class ByteSource {
public:
    ByteSource(std::string_view from, bool base64, const char* field, const FileReader& reader)
        : from_(from), base64_(base64), field_(field), reader_(reader) {}

    /// Upper limit of the number of bytes that take() can still return. Padding of base64 makes the number smaller.
    std::size_t most_left() const { return base64_ ? ready_.size() + from_.size() / 4 * 3 : from_.size(); }

    std::string take(std::size_t count) {
        if (count > most_left())
            complain("the end of the data", std::to_string(count) + " more bytes, of which at most " +
                                                std::to_string(most_left()) + " are left");
        std::string bytes;
        if (!base64_) {
            bytes = from_.substr(0, count);
            from_.remove_prefix(count);
            return bytes;
        }
        while (ready_.size() < count) decode_four();
        bytes = ready_.substr(0, count);
        ready_.erase(0, count);
        return bytes;
    }
    /// Throws SceneError. Its message says by `field_` which numbers were to be read.
    [[noreturn]] void complain(const std::string& found, const std::string& expected) const {
        reader_.complain(field_, found, expected, damaged);
    }

private:
    void decode_four() {
        std::uint32_t bits = 0;
        int padding = 0;
        for (int i = 0; i < 4; ++i) {
            const char c = next();
            const std::optional<std::uint32_t> digit = digit_of(c);
            const bool pads = c == '=' && i >= 2;
            if ((!digit && !pads) || (digit && padding > 0))
                complain("the character " + in_quotes({&c, 1}), "a character of base64 (A-Z, a-z, 0-9, +, /)");
            padding += pads;
            bits = bits << 6 | digit.value_or(0);
        }
        for (int byte = 0; byte < 3 - padding; ++byte) ready_ += static_cast<char>(bits >> (16 - 8 * byte) & 255);
    }
    char next() {
        while (!from_.empty() && is_space(from_.front())) from_.remove_prefix(1);
        if (from_.empty()) complain("the end of the data", "more characters of base64");
        const char c = from_.front();
        from_.remove_prefix(1);
        return c;
    }
    static std::optional<std::uint32_t> digit_of(char c) {
        if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
        if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a' + 26);
        if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0' + 52);
        if (c == '+') return 62;
        if (c == '/') return 63;
        return {};
    }

    std::string_view from_;
    bool base64_;
    const char* field_;
    const FileReader& reader_;
    std::string ready_;  // decoded bytes that were not taken yet
};

template <class T>
T number_from(const char* bytes, bool swapped) {
    std::array<char, sizeof(T)> own;
    std::copy_n(bytes, sizeof(T), own.begin());
    if (swapped) std::ranges::reverse(own);
    T value;
    std::memcpy(&value, own.data(), sizeof(T));
    return value;
}

std::uint64_t read_header(ByteSource& source, const VtkXmlForm& form) {
    const std::string bytes = source.take(form.wide_header ? 8 : 4);
    return form.wide_header ? number_from<std::uint64_t>(bytes.data(), form.swapped_bytes)
                            : number_from<std::uint32_t>(bytes.data(), form.swapped_bytes);
}

/// Reads and decompresses the blocks of an array. A header precedes them: number of blocks, decompressed size of a
/// block, decompressed size of the last block (0: like the others), and compressed size of each block. `expected`:
/// decompressed size of all blocks [bytes].
std::string read_blocks(ByteSource& source, const VtkXmlForm& form, std::size_t expected) {
    // Largest compression ratio of zlib. A block with a larger ratio is damaged, and is refused before memory is
    // allocated.
    constexpr std::size_t best_ratio = 1032;
    const std::uint64_t count = read_header(source, form), size = read_header(source, form),
                        last = read_header(source, form);
    const std::uint64_t whole = count - (last > 0 && count > 0 ? 1 : 0);
    const bool plausible = count <= source.most_left() && last <= expected && (whole == 0 || size <= expected) &&
                           (size == 0 || whole <= expected / size);
    if (!plausible || whole * size + last * (count - whole) != expected)
        source.complain(std::to_string(count) + " blocks of " + std::to_string(size) + " bytes, the last of " +
                            std::to_string(last) + " bytes",
                        "blocks of " + std::to_string(expected) + " bytes in all");
    std::vector<std::uint64_t> packed;
    for (std::uint64_t b = 0; b < count; ++b) packed.push_back(read_header(source, form));
    std::string bytes;
    for (std::uint64_t b = 0; b < count; ++b) {
        const auto own = static_cast<std::size_t>(b < whole ? size : last);
        const std::string block = source.take(static_cast<std::size_t>(packed[b]));
        std::optional<std::string> unpacked;
        if (own / best_ratio <= block.size()) unpacked = inflated(block, own);
        if (!unpacked)
            source.complain("compressed block " + std::to_string(b + 1) + " of " + std::to_string(count) +
                                ", which zlib cannot decompress to " + std::to_string(own) + " bytes",
                            "an undamaged block");
        bytes += *unpacked;
    }
    return bytes;
}

std::string read_bytes(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t expected, const char* field,
                       const FileReader& reader) {
    const std::string_view format = array.tag.value_of("format", "ascii");
    std::string_view from = array.text;
    bool base64 = true;
    if (format == "appended") {
        if (!form.has_appended)
            reader.complain("format", "\"appended\", but the file has no <AppendedData>", "a section <AppendedData>",
                            damaged);
        const std::int64_t offset = reader.parse_integer(array.tag.value_of("offset"), "offset");
        if (offset < 0 || static_cast<std::uint64_t>(offset) > form.appended.size())
            reader.complain("offset", std::to_string(offset),
                            "0 to " + std::to_string(form.appended.size()) + ", the size of <AppendedData>", damaged);
        from = form.appended.substr(static_cast<std::size_t>(offset));
        base64 = form.appended_base64;
    } else if (format != "binary") {
        reader.complain("format", in_quotes(format), "ascii, binary or appended");
    }
    ByteSource source(from, base64, field, reader);
    if (form.compressed) return read_blocks(source, form, expected);
    if (const std::uint64_t size = read_header(source, form); size != expected)
        source.complain(std::to_string(size) + " bytes", std::to_string(expected) + " bytes");
    return source.take(expected);
}

template <class Number, class T>
std::vector<Number> converted(const std::string& bytes, bool swapped) {
    std::vector<Number> numbers(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = static_cast<Number>(number_from<T>(bytes.data() + i * sizeof(T), swapped));
    return numbers;
}

template <class Number>
std::vector<Number> read_text(const VtkXmlArray& array, std::size_t count, const char* field, FileReader& reader) {
    std::vector<Number> numbers;
    std::size_t words = 0;
    for (std::string_view text = array.text;;) {
        while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
        if (text.empty()) break;
        std::size_t end = 0;
        while (end < text.size() && !is_space(text[end])) ++end;
        if (++words <= count) {
            if constexpr (std::is_floating_point_v<Number>)
                numbers.push_back(reader.parse_real(text.substr(0, end), field));
            else
                numbers.push_back(reader.parse_integer(text.substr(0, end), field));
        }
        text.remove_prefix(end);
    }
    if (words != count)
        reader.complain(field, std::to_string(words) + " numbers", std::to_string(count) + " numbers", damaged);
    return numbers;
}

template <class Number>
std::vector<Number> numbers_of(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t count, const char* field,
                               FileReader& reader) {
    reader.go_to(array.tag.place);
    reader.set_section(array.section);
    struct Type {
        std::string_view id;
        std::size_t size;  // [bytes]
        std::vector<Number> (*convert)(const std::string&, bool);
    };
    static constexpr Type types[] = {
        {"Float64", 8, converted<Number, double>},       {"Float32", 4, converted<Number, float>},
        {"Int64", 8, converted<Number, std::int64_t>},   {"Int32", 4, converted<Number, std::int32_t>},
        {"Int16", 2, converted<Number, std::int16_t>},   {"Int8", 1, converted<Number, std::int8_t>},
        {"UInt64", 8, converted<Number, std::uint64_t>}, {"UInt32", 4, converted<Number, std::uint32_t>},
        {"UInt16", 2, converted<Number, std::uint16_t>}, {"UInt8", 1, converted<Number, std::uint8_t>}};
    const std::string_view name = array.tag.value_of("type");
    const Type* const type = std::ranges::find(types, name, &Type::id);
    const bool real = name.starts_with("Float");
    if (type == std::end(types) || (real && !std::is_floating_point_v<Number>))
        reader.complain("type", in_quotes(name),
                        std::is_floating_point_v<Number> ? "Float32, Float64 or an integer type such as Int32"
                                                         : "an integer type such as Int32 or Int64");
    if (array.tag.value_of("format", "ascii") == "ascii") return read_text<Number>(array, count, field, reader);
    return type->convert(read_bytes(array, form, count * type->size, field, reader), form.swapped_bytes);
}

}  // namespace

std::string_view bytes_of(const FileReader& reader) {
    const std::string_view rest = reader.rest();
    return {rest.data() - reader.position(), reader.position() + rest.size()};
}

std::string_view XmlTag::value_of(std::string_view attribute, std::string_view otherwise) const {
    for (const auto& [key, value] : attributes)
        if (key == attribute) return value;
    return otherwise;
}

XmlTag next_tag(FileReader& reader) {
    const std::string_view bytes = bytes_of(reader);
    std::size_t begin = place_of("<", reader.position(), reader);
    for (std::string_view rest = bytes.substr(begin); rest.starts_with("<?") || rest.starts_with("<!");
         rest = bytes.substr(begin)) {
        const std::string_view end = rest.starts_with("<!--") ? "-->" : rest.starts_with("<?") ? "?>" : ">";
        begin = place_of("<", place_of(end, begin, reader) + end.size(), reader);
    }
    reader.go_to(begin);
    // A quoted value may contain ">". With an odd number of quotes before it, ">" is inside a value.
    std::size_t end = place_of(">", begin, reader);
    while (std::ranges::count(bytes.substr(begin, end - begin), '"') % 2 != 0) end = place_of(">", end + 1, reader);
    std::string_view inner = bytes.substr(begin + 1, end - begin - 1);
    XmlTag tag;
    tag.place = begin;
    tag.end = end + 1;
    if (inner.starts_with('/')) {
        tag.opens = false;
        tag.closes = true;
        inner.remove_prefix(1);
    } else if (inner.ends_with('/')) {
        tag.closes = true;
        inner.remove_suffix(1);
    }
    std::size_t length = 0;
    while (length < inner.size() && !is_space(inner[length])) ++length;
    tag.name = inner.substr(0, length);
    if (tag.name.empty()) reader.complain({}, "a tag without a name", "<NAME ...>", damaged);
    read_attributes(inner.substr(length), tag, reader);
    reader.go_to(tag.end);
    return tag;
}

std::vector<Real> reals_of(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t count, const char* field,
                           FileReader& reader) {
    return numbers_of<Real>(array, form, count, field, reader);
}
std::vector<std::int64_t> integers_of(const VtkXmlArray& array, const VtkXmlForm& form, std::size_t count,
                                      const char* field, FileReader& reader) {
    return numbers_of<std::int64_t>(array, form, count, field, reader);
}

}  // namespace skerry::mesh
