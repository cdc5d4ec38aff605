#include "engine/mesh/formats/read_gmsh.h"

namespace skerry::mesh {
namespace {

// Size of the shortest line of text that defines a node: "1 0 0 0" and a line end [bytes].
constexpr std::size_t shortest_row = 8;
// Size of a node in a binary file: a 4-byte number and three 8-byte coordinates [bytes].
constexpr std::size_t binary_node = 4 + 3 * 8;

/// Returns the words of the next line. Throws SceneError if a new section begins there, because then rows are missing.
const std::vector<std::string_view>& row_words(FileReader& reader, const char* expected) {
    const std::string_view text = reader.filled_line(expected);
    if (text.front() == '$')
        reader.complain({}, in_quotes(text), expected,
                        "the section has fewer rows than its header announces; correct the header");
    return reader.words_of(text);
}

std::vector<std::int64_t> parse_nodes(const FileReader& reader, const std::vector<std::string_view>& words,
                                      std::size_t begin) {
    std::vector<std::int64_t> nodes;
    for (std::size_t i = begin; i < words.size(); ++i) nodes.push_back(reader.parse_integer(words[i], "node"));
    return nodes;
}

void require_words(const FileReader& reader, std::size_t found, std::size_t expected, const char* meaning) {
    if (found != expected)
        reader.complain({}, std::to_string(found) + " numbers", std::to_string(expected) + " numbers: " + meaning);
}

}  // namespace

void read_gmsh2_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh) {
    const std::int64_t announced = integer_line(reader, 1, "count", "the number of nodes")[0];
    const std::size_t count = reader.checked_count(announced, binary ? binary_node : shortest_row, "count");
    numbers.reserve(count);
    mesh.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("node", i + 1, count);
        Vec3 x;
        if (binary) {
            numbers.add(reader.binary<std::int32_t>("number"), reader);
            for (Real& value : x) value = reader.finite(reader.binary<double>("position"), "position");
        } else {
            const std::vector<std::string_view>& words = row_words(reader, "number, x, y and z of a node");
            require_words(reader, words.size(), 4, "number, x, y and z of a node");
            numbers.add(reader.parse_integer(words[0], "number"), reader);
            for (std::size_t a = 0; a < 3; ++a)
                x[static_cast<Eigen::Index>(a)] =
                    reader.finite(reader.parse_real(words[a + 1], "position"), "position");
        }
        mesh.nodes.push_back(x);
    }
    reader.set_section("$Nodes");
}

namespace {

/// Returns the number of the physical group of an element, or nothing if the element is in no group. A negative number
/// in the file means the same group as its absolute value; the sign only reverses the orientation.
std::vector<std::int64_t> group_of(const GmshTags& tags) {
    if (tags.physical == 0) return {};
    return {tags.physical < 0 ? -tags.physical : tags.physical};
}

}  // namespace

void read_gmsh1_elements(FileReader& reader, const NodeNumbers& numbers, GmshMesh& mesh) {
    constexpr const char* element_row = "number, type, physical group, elementary entity, node count and nodes";
    const std::size_t count = reader.checked_count(integer_line(reader, 1, "count", "the number of elements")[0],
                                                   2 * shortest_row - 4, "count");
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("element", i + 1, count);
        const std::vector<std::string_view>& words = row_words(reader, element_row);
        if (words.size() < 5)
            reader.complain({}, std::to_string(words.size()) + " numbers",
                            std::string("at least 6 numbers: ") + element_row);
        const std::int64_t type = reader.parse_integer(words[1], "type");
        const std::size_t nodes = gmsh_node_count(type, reader);
        if (const std::int64_t tag_count = reader.parse_integer(words[4], "node count");
            tag_count != static_cast<std::int64_t>(nodes))
            reader.complain("node count", std::to_string(tag_count),
                            std::to_string(nodes) + ", the node count of elements of type " + std::to_string(type));
        require_words(reader, words.size(), 5 + nodes, element_row);
        const GmshTags tags{.physical = reader.parse_integer(words[2], "physical group"),
                            .elementary = reader.parse_integer(words[3], "elementary entity")};
        take_gmsh_element(type, parse_nodes(reader, words, 5), tags, group_of(tags), numbers, reader, mesh);
    }
    reader.set_section("$ELM");
}

namespace {

void read_ascii_element(FileReader& reader, const NodeNumbers& numbers, GmshMesh& mesh) {
    const std::vector<std::string_view>& words =
        row_words(reader, "number, type, tag count, tags and nodes of an element");
    if (words.size() < 4)
        reader.complain({}, std::to_string(words.size()) + " numbers",
                        "at least 4 numbers: number, type, tag count and a node");
    const std::int64_t type = reader.parse_integer(words[1], "type");
    const std::size_t nodes = gmsh_node_count(type, reader);
    const std::int64_t tags = reader.parse_integer(words[2], "tag count");
    if (tags < 0 || tags > static_cast<std::int64_t>(words.size()))
        reader.complain("tag count", std::to_string(tags), "a tag count >= 0 that fits the numbers in this line");
    require_words(reader, words.size(), 3 + static_cast<std::size_t>(tags) + nodes,
                  "number, type, tag count, tags and nodes of an element");
    GmshTags own{.number = reader.parse_integer(words[0], "number")};
    if (tags > 0) own.physical = reader.parse_integer(words[3], "physical group");
    if (tags > 1) own.elementary = reader.parse_integer(words[4], "elementary entity");
    take_gmsh_element(type, parse_nodes(reader, words, 3 + static_cast<std::size_t>(tags)), own, group_of(own), numbers,
                      reader, mesh);
}

/// Reads a block of a binary file, and returns the number of its elements. A block is a header, followed by elements
/// that all have the type and the number of tags given in the header. `count`: number of elements of the section.
/// `done`: number of those in earlier blocks.
std::size_t read_binary_block(FileReader& reader, std::size_t done, std::size_t count, const NodeNumbers& numbers,
                              GmshMesh& mesh) {
    const auto type = reader.binary<std::int32_t>("type");
    const std::size_t nodes = gmsh_node_count(type, reader);
    const auto announced = reader.binary<std::int32_t>("elements of a block");
    const auto tags = reader.binary<std::int32_t>("tag count");
    const std::size_t tag_count = reader.checked_count(tags, 4, "tag count");
    const std::size_t rows = reader.checked_count(announced, 4 * (1 + tag_count + nodes), "elements of a block");
    if (rows == 0 || rows > count - done)
        reader.complain("elements of a block", std::to_string(rows), "1 to " + std::to_string(count - done),
                        "the section has only " + std::to_string(count - done) +
                            " elements left; correct the count of this block or of the section");
    std::vector<std::int64_t> node_numbers(nodes);
    for (std::size_t i = 0; i < rows; ++i) {
        reader.set_row("element", done + i + 1, count);
        GmshTags own{.number = reader.binary<std::int32_t>("number")};
        for (std::size_t i_tag = 0; i_tag < tag_count; ++i_tag) {
            const auto tag = reader.binary<std::int32_t>("tag");
            if (i_tag == 0) own.physical = tag;
            if (i_tag == 1) own.elementary = tag;
        }
        for (std::int64_t& number : node_numbers) number = reader.binary<std::int32_t>("node");
        take_gmsh_element(type, node_numbers, own, group_of(own), numbers, reader, mesh);
    }
    return rows;
}

}  // namespace

void read_gmsh2_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, GmshMesh& mesh) {
    const std::size_t count =
        reader.checked_count(integer_line(reader, 1, "count", "the number of elements")[0], 8, "count");
    for (std::size_t done = 0; done < count;) {
        reader.set_row("element", done + 1, count);
        if (binary) {
            done += read_binary_block(reader, done, count, numbers, mesh);
        } else {
            read_ascii_element(reader, numbers, mesh);
            ++done;
        }
    }
    reader.set_section("$Elements");
}

}  // namespace skerry::mesh
