#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include "engine/mesh/formats/read_gmsh.h"

namespace skerry::mesh {
namespace {

using Numbers4 = std::array<std::int64_t, 4>;

/// Reads four integers. In a text file they stand on one line. In a binary file `sizes` gives the size of each (4 or 8)
/// [bytes].
Numbers4 read_four(FileReader& reader, bool binary, const std::array<int, 4>& sizes, const char* field,
                   const char* meaning) {
    Numbers4 numbers;
    if (binary) {
        for (std::size_t i = 0; i < 4; ++i)
            numbers[i] = sizes[i] == 8 ? static_cast<std::int64_t>(reader.binary<std::uint64_t>(field))
                                       : reader.binary<std::int32_t>(field);
    } else {
        const std::vector<std::int64_t> line = integer_line(reader, 4, field, meaning);
        std::copy(line.begin(), line.end(), numbers.begin());
    }
    return numbers;
}

/// Reads the header of the section $Nodes (or $Elements): number of blocks, number of nodes (elements), smallest number
/// of a node (element), and largest number.
Numbers4 read_section_header(FileReader& reader, bool binary, std::size_t row_bytes) {
    const Numbers4 header =
        read_four(reader, binary, {8, 8, 8, 8}, "header",
                  "4 integers: count of blocks, count of all their rows, smallest and largest row number");
    reader.checked_count(header[0], binary ? 20 : 8, "count of blocks");
    reader.checked_count(header[1], row_bytes, "count of rows");
    return header;
}

/// Reads the header of a block: dimension of the geometric entity, its tag, parametric flag (for nodes) or element type
/// (for elements), and number of rows.
Numbers4 read_block_header(FileReader& reader, bool binary, const char* meaning) {
    const Numbers4 block = read_four(reader, binary, {4, 4, 4, 8}, "block header", meaning);
    if (block[0] < 0 || block[0] > 3) reader.complain("dimension", std::to_string(block[0]), "0 to 3");
    return block;
}

/// Reads the next word of a row of the section. Throws SceneError if a new section begins there, because then rows are
/// missing.
std::string_view row_word(FileReader& reader, const char* expected) {
    const std::string_view text = reader.word(expected);
    if (text.front() == '$')
        reader.complain({}, in_quotes(text), expected,
                        "the section has fewer rows than its header announces; correct the header");
    return text;
}

/// Reads the tag of a geometric entity or of a physical group.
std::int64_t read_tag(FileReader& reader, bool binary) {
    return binary ? reader.binary<std::int32_t>("tag") : reader.parse_integer(row_word(reader, "a tag"), "tag");
}

/// Reads a number of tags, followed by the tags.
std::vector<std::int64_t> read_tags(FileReader& reader, bool binary) {
    const std::int64_t announced = binary ? static_cast<std::int64_t>(reader.binary<std::uint64_t>("count of tags"))
                                          : reader.parse_integer(row_word(reader, "a count of tags"), "count of tags");
    std::vector<std::int64_t> tags(reader.checked_count(announced, binary ? 4 : 2, "count of tags"));
    for (std::int64_t& tag : tags) tag = read_tag(reader, binary);
    return tags;
}

void require_total(const FileReader& reader, std::size_t found, std::int64_t announced) {
    if (found != static_cast<std::size_t>(announced))
        reader.complain("count of rows", std::to_string(announced) + " in the header of the section",
                        std::to_string(found),
                        "the blocks of this section announce that many rows in total; the header must agree");
}

/// Reads a block of `rows` nodes: first the numbers of all nodes, then their positions. Each position is followed by
/// `parameters` parametric coordinates, which are skipped. `total`: number of nodes in the file. `range`: smallest and
/// largest node number so far, to be updated.
void read_node_block(FileReader& reader, bool binary, std::size_t rows, std::size_t parameters, std::size_t total,
                     NodeNumbers& numbers, std::array<std::int64_t, 2>& range, GmshMesh& mesh) {
    const std::size_t first = mesh.nodes.size();
    for (std::size_t i = 0; i < rows; ++i) {
        reader.set_row("number of node", first + i + 1, total);
        const std::int64_t number = binary ? static_cast<std::int64_t>(reader.binary<std::uint64_t>("number"))
                                           : reader.parse_integer(row_word(reader, "a node number"), "number");
        numbers.add(number, reader);
        range = {std::min(range[0], number), std::max(range[1], number)};
    }
    for (std::size_t i = 0; i < rows; ++i) {
        reader.set_row("position of node", first + i + 1, total);
        Vec3 x;
        for (std::size_t a = 0; a < 3 + parameters; ++a) {
            const Real value = binary ? reader.binary<double>("position")
                                      : reader.parse_real(row_word(reader, "a coordinate"), "position");
            if (a < 3) x[static_cast<Eigen::Index>(a)] = reader.finite(value, "position");
        }
        mesh.nodes.push_back(x);
    }
}

}  // namespace

void read_gmsh4_nodes(FileReader& reader, bool binary, NodeNumbers& numbers, GmshMesh& mesh) {
    const std::size_t row_bytes = binary ? 32 : 8;
    const Numbers4 header = read_section_header(reader, binary, row_bytes);
    std::array<std::int64_t, 2> range{std::numeric_limits<std::int64_t>::max(),
                                      std::numeric_limits<std::int64_t>::min()};
    for (std::int64_t b = 0; b < header[0]; ++b) {
        reader.set_row("block", static_cast<std::size_t>(b) + 1, static_cast<std::size_t>(header[0]));
        const Numbers4 block = read_block_header(
            reader, binary, "4 integers: dimension, tag, parametric flag (0 or 1), count of nodes in the block");
        const std::size_t rows = reader.checked_count(block[3], row_bytes, "nodes of the block");
        const std::size_t parameters = block[2] != 0 ? static_cast<std::size_t>(block[0]) : 0;
        read_node_block(reader, binary, rows, parameters, static_cast<std::size_t>(header[1]), numbers, range, mesh);
    }
    reader.set_section("$Nodes");
    require_total(reader, mesh.nodes.size(), header[1]);
    if (!mesh.nodes.empty() && (header[2] != range[0] || header[3] != range[1]))
        reader.complain("header", "node numbers " + std::to_string(header[2]) + " to " + std::to_string(header[3]),
                        std::to_string(range[0]) + " to " + std::to_string(range[1]),
                        "the blocks of this section contain numbers in that range; the header must agree");
}

GmshEntities read_gmsh4_entities(FileReader& reader, bool binary) {
    const Numbers4 count =
        read_four(reader, binary, {8, 8, 8, 8}, "header", "4 integers: counts of points, curves, surfaces and volumes");
    constexpr std::array<const char*, 4> kind{"point", "curve", "surface", "volume"};
    GmshEntities entities;
    for (std::size_t dimension = 0; dimension < 4; ++dimension) {
        const std::size_t rows = reader.checked_count(count[dimension], binary ? 36 : 8, "count of entities");
        for (std::size_t i = 0; i < rows; ++i) {
            reader.set_row(kind[dimension], i + 1, rows);
            const std::int64_t tag = read_tag(reader, binary);
            // skips the position of a point, or the bounding box of any other entity
            for (int a = 0; a < (dimension == 0 ? 3 : 6); ++a)
                binary ? void(reader.binary<double>("position")) : void(row_word(reader, "a coordinate"));
            std::vector<std::int64_t> groups = read_tags(reader, binary);
            if (dimension > 0) read_tags(reader, binary);  // skips the tags of the entity's boundary
            // a negative number means the same group as its absolute value; the sign only reverses the orientation of
            // the group's elements
            for (std::int64_t& group : groups) group = group < 0 ? -group : group;
            if (!groups.empty()) entities[{static_cast<std::int64_t>(dimension), tag}] = std::move(groups);
        }
    }
    reader.set_section("$Entities");
    return entities;
}

void read_gmsh4_elements(FileReader& reader, bool binary, const NodeNumbers& numbers, const GmshEntities& entities,
                         GmshMesh& mesh) {
    const Numbers4 header = read_section_header(reader, binary, binary ? 16 : 4);
    std::size_t total = 0;
    for (std::int64_t b = 0; b < header[0]; ++b) {
        reader.set_row("block", static_cast<std::size_t>(b) + 1, static_cast<std::size_t>(header[0]));
        const Numbers4 block = read_block_header(
            reader, binary, "4 integers: dimension, tag, element type, count of elements in the block");
        const std::size_t nodes = gmsh_node_count(block[2], reader);
        const std::size_t rows =
            reader.checked_count(block[3], (nodes + 1) * (binary ? 8 : 2), "elements of the block");
        const auto entity = entities.find({block[0], block[1]});
        const std::span<const std::int64_t> groups =
            entity == entities.end() ? std::span<const std::int64_t>() : entity->second;
        GmshTags tags{.physical = groups.empty() ? 0 : groups.front(), .elementary = block[1]};
        std::vector<std::int64_t> node_numbers(nodes);
        for (std::size_t i = 0; i < rows; ++i) {
            reader.set_row("element", ++total, static_cast<std::size_t>(header[1]));
            if (binary) {
                tags.number = static_cast<std::int64_t>(reader.binary<std::uint64_t>("number"));
                for (std::int64_t& number : node_numbers)
                    number = static_cast<std::int64_t>(reader.binary<std::uint64_t>("node"));
            } else {
                const std::string_view text = reader.filled_line("the number and the nodes of an element");
                if (text.front() == '$')
                    reader.complain({}, in_quotes(text), "the number and the nodes of an element",
                                    "the section has fewer rows than its header announces; correct the header");
                const std::vector<std::string_view>& words = reader.words_of(text);
                if (words.size() != nodes + 1)
                    reader.complain({}, in_quotes(text),
                                    std::to_string(nodes + 1) + " integers: the number and the nodes of an element");
                tags.number = reader.parse_integer(words[0], "number");
                for (std::size_t a = 0; a < nodes; ++a) node_numbers[a] = reader.parse_integer(words[a + 1], "node");
            }
            take_gmsh_element(block[2], node_numbers, tags, groups, numbers, reader, mesh);
        }
    }
    reader.set_section("$Elements");
    require_total(reader, total, header[1]);
}

}  // namespace skerry::mesh
