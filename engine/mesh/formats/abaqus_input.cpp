#include "engine/mesh/formats/abaqus_input.h"

#include <algorithm>

namespace skerry::mesh {
namespace {

bool is_comment(std::string_view line) {
    return line.empty() || line.starts_with("**");
}

/// Adds the fields of a line to `fields`. Returns true if the line ends with a comma, after which the row may continue
/// in the next line.
bool add_fields(std::string_view line, std::vector<std::string>& fields) {
    for (std::size_t begin = 0; begin < line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        fields.emplace_back(trimmed(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    return line.ends_with(',');
}

std::string without_quotes(std::string_view text) {
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return std::string(text);
}

/// Makes a block from the fields of a keyword line. The first field is the keyword, the others are parameters.
AbaqusBlock block_of(const std::vector<std::string>& fields) {
    AbaqusBlock block;
    for (const std::string& field : fields) {
        if (&field == fields.data()) {
            block.keyword = in_upper_case(trimmed(std::string_view(field).substr(1)));
            continue;
        }
        const std::size_t sign = std::min(field.find('='), field.size());
        const std::string_view value = sign < field.size() ? std::string_view(field).substr(sign + 1) : "";
        block.parameter[in_upper_case(trimmed(std::string_view(field).substr(0, sign)))] =
            without_quotes(trimmed(value));
    }
    return block;
}

}  // namespace

std::string AbaqusBlock::value(const char* name) const {
    const auto found = parameter.find(name);
    return found == parameter.end() ? std::string() : found->second;
}

std::vector<AbaqusBlock> abaqus_blocks(FileReader& reader) {
    std::vector<AbaqusBlock> blocks;
    while (!reader.at_end()) {
        const std::size_t place = reader.position();
        std::string_view line = reader.line();
        if (is_comment(line)) continue;
        if (line.front() == '*') {
            std::vector<std::string> fields;
            while (add_fields(line, fields) && reader.remaining() > 0) line = reader.line();
            blocks.push_back(block_of(fields));
            blocks.back().place = place;
            blocks.back().first = reader.position();
        } else if (blocks.empty()) {
            reader.complain({}, in_quotes(line), "a keyword line, which begins with *",
                            "check that this is an input file of Abaqus");
        }
        blocks.back().end = reader.position();
    }
    return blocks;
}

void for_each_abaqus_row(FileReader& reader, const AbaqusBlock& block, std::size_t fields,
                         const std::function<void(const std::vector<std::string>&)>& take) {
    reader.go_to(block.first);
    reader.set_section("*" + block.keyword);
    std::vector<std::string> row;
    while (reader.position() < block.end) {
        const std::string_view line = reader.line();
        if (is_comment(line) || (add_fields(line, row) && row.size() < fields)) continue;
        take(row);
        row.clear();
    }
    if (!row.empty()) take(row);
}

void go_to_keyword(FileReader& reader, const AbaqusBlock& block) {
    reader.go_to(block.place);
    reader.set_section("*" + block.keyword);
}

}  // namespace skerry::mesh
