#include "engine/mesh/formats/read_gmsh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace skerry::mesh {
namespace {

// Number of nodes of a Gmsh element, by the code of its type ("MSH file format" in the manual). The code 0 does not
// exist.
constexpr std::array<std::size_t, 32> nodes_of_type{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                                    8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

bool is_gmsh_tetrahedron(std::int64_t type) {
    return type == 4 || type == 11;  // codes of first and second order elements
}
bool is_triangle(std::int64_t type) {
    return type == 2 || type == 9;  // codes of first and second order elements
}
bool is_curved_tetrahedron(std::int64_t type) {
    return (type >= 29 && type <= 31) || (type >= 71 && type <= 75);
}
bool is_curved_triangle(std::int64_t type) {
    return type >= 20 && type <= 25;
}

std::string kind_of(std::int64_t type) {
    constexpr std::array<std::int64_t, 5> lines{1, 8, 26, 27, 28}, hexahedra{5, 12, 17, 92, 93};
    constexpr std::array<std::int64_t, 3> quadrilaterals{3, 10, 16}, prisms{6, 13, 18}, pyramids{7, 14, 19};
    const auto is_in = [&](const auto& types) { return std::ranges::find(types, type) != types.end(); };
    if (is_curved_triangle(type)) return "triangles of third or higher order";
    if (type == 15) return "points";
    if (is_in(lines)) return "lines";
    if (is_in(quadrilaterals)) return "quadrilaterals";
    if (is_in(hexahedra)) return "hexahedra";
    if (is_in(prisms)) return "prisms";
    if (is_in(pyramids)) return "pyramids";
    return "elements of type " + std::to_string(type);
}

std::int64_t dimension_of(std::int64_t type) {
    const std::string kind = kind_of(type);
    if (kind == "points") return 0;
    if (kind == "lines") return 1;
    return is_triangle(type) || is_curved_triangle(type) || kind == "quadrilaterals" ? 2 : 3;
}

}  // namespace

std::size_t gmsh_node_count(std::int64_t type, const FileReader& reader) {
    if (is_curved_tetrahedron(type))
        reader.complain("type", std::to_string(type) + ", a tetrahedron of third or higher order",
                        "type 4 or 11, a tetrahedron of first or second order",
                        "in Gmsh set Mesh.ElementOrder = 1, then create the mesh again");
    if (type == 92 || type == 93) return type == 92 ? 64 : 125;
    const std::size_t count = type > 0 && type < static_cast<std::int64_t>(nodes_of_type.size())
                                  ? nodes_of_type[static_cast<std::size_t>(type)]
                                  : 0;
    if (count == 0) reader.complain("type", std::to_string(type), "an element type of Gmsh: 1 to 31, 92 or 93");
    return count;
}

void take_gmsh_element(std::int64_t type, const std::vector<std::int64_t>& node_numbers, const GmshTags& tags,
                       std::span<const std::int64_t> groups, const NodeNumbers& numbers, const FileReader& reader,
                       GmshMesh& mesh) {
    std::vector<Index>& rows = mesh.element_nodes;
    rows.clear();
    for (const std::int64_t number : node_numbers) rows.push_back(numbers.row(number, reader));
    if (type == 11) std::swap(rows[8], rows[9]);  // Gmsh lists the middle of edge 23 before that of edge 13
    // In version 2, a tetrahedron that belongs to several groups has a row for each group. These rows follow each
    // other; `again` is true for all but the first.
    const bool again = is_gmsh_tetrahedron(type) && !mesh.tetrahedra.empty() &&
                       std::ranges::equal(mesh.tetrahedra.back(), std::span(rows).first(4)) &&
                       mesh.tags.back().elementary == tags.elementary && mesh.tags.back().physical != tags.physical;
    for (const std::int64_t group : groups) {
        MeshSet& set = mesh.groups[{dimension_of(type), group}];
        if (is_gmsh_tetrahedron(type))
            set.tetrahedra.push_back(static_cast<Index>(mesh.tetrahedra.size() - (again ? 1 : 0)));
        else if (is_triangle(type))
            set.faces.push_back({rows[0], rows[1], rows[2]});
        else
            set.nodes.insert(set.nodes.end(), rows.begin(), rows.end());
    }
    if (again) return;
    if (is_gmsh_tetrahedron(type)) {
        take_tetrahedron(rows, reader, mesh);
        mesh.tags.push_back(tags);
    } else if (is_triangle(type)) {
        take_triangle(rows, reader, mesh);
    } else {
        mesh.curved_triangles += is_curved_triangle(type);
        mesh.others[kind_of(type)] += 1;
    }
}

std::vector<std::int64_t> integer_line(FileReader& reader, std::size_t count, const char* field, const char* meaning) {
    const std::string_view text = reader.filled_line(meaning);
    const std::vector<std::string_view>& words = reader.words_of(text);
    if (words.size() != count) reader.complain(field, in_quotes(text), meaning);
    std::vector<std::int64_t> numbers;
    for (const std::string_view word : words) numbers.push_back(reader.parse_integer(word, field));
    return numbers;
}

namespace {

struct Header {
    int version = 1;
    bool binary = false;
};

/// Reads the lines of section $MeshFormat, up to and including $EndMeshFormat.
Header read_header(FileReader& reader) {
    reader.set_section("$MeshFormat");
    const std::string_view text = reader.filled_line("three values: version, file type and data size");
    const std::vector<std::string_view>& words = reader.words_of(text);
    if (words.size() != 3) reader.complain({}, in_quotes(text), "three values: version, file type and data size");
    const std::string version(words[0]);
    Header header;
    if (version == "4.1")
        header.version = 4;
    else if (version == "2" || version == "2.0" || version == "2.1" || version == "2.2")
        header.version = 2;
    else
        reader.complain("version", in_quotes(version), "1, 2.0 to 2.2, or 4.1",
                        "convert the file with: gmsh OLD.msh -3 -format msh41 -o NEW.msh");
    const std::int64_t type = reader.parse_integer(words[1], "file type"),
                       size = reader.parse_integer(words[2], "data size");
    if (type != 0 && type != 1) reader.complain("file type", std::to_string(type), "0 (ASCII) or 1 (binary)");
    header.binary = type == 1;
    if (header.binary && size != 8) reader.complain("data size", std::to_string(size), "8 (bytes per number)");
    if (header.binary) {
        const auto endian_mark = reader.binary<std::uint32_t>("byte order");
        if (endian_mark != 1 && endian_mark != 0x01000000)
            reader.complain("byte order", std::to_string(endian_mark), "the integer 1, big-endian or little-endian",
                            "the file is damaged; export it again");
        reader.set_swapped_bytes(endian_mark != 1);
    }
    if (const std::string_view end = reader.filled_line("$EndMeshFormat"); end != "$EndMeshFormat")
        reader.complain({}, in_quotes(end), "$EndMeshFormat");
    return header;
}

void require_end(FileReader& reader, const std::string& mark) {
    if (const std::string_view end = reader.filled_line(mark.c_str()); end != mark)
        reader.complain({}, in_quotes(end), mark,
                        "if the section has more rows than its header announces, correct the count in the header");
}

/// Sets the label of each tetrahedron to the number of its physical group, which users choose. If no tetrahedron is in
/// a group, uses the numbers of the geometric volumes. Sets no labels if one of the numbers does not fit 32 bits.
void label(GmshMesh& mesh) {
    const bool grouped = std::ranges::any_of(mesh.tags, [](const GmshTags& tags) { return tags.physical != 0; });
    std::vector<int> labels;
    for (const GmshTags& tags : mesh.tags) {
        // a negative number means the same group as its absolute value; the sign only reverses the orientation
        const Real tag = static_cast<Real>(grouped ? tags.physical : tags.elementary);
        const std::optional<int> number = as_label(grouped ? std::abs(tag) : tag);
        if (!number) return;
        labels.push_back(*number);
    }
    mesh.label = std::move(labels);
}

/// Adds the physical groups and GmshMesh::flagged to the sets of the mesh. A group without a name is named after its
/// dimension and number. A group of volumes without a name gives no set, because its number is already a label.
void name_groups(GmshMesh& mesh) {
    constexpr std::array<const char*, 3> kinds{"point_", "curve_", "surface_"};
    for (auto& [group, set] : mesh.groups) {
        const auto [dimension, number] = group;
        const auto named = mesh.group_names.find(group);
        if (named == mesh.group_names.end() && dimension == 3) continue;
        const std::string name = named != mesh.group_names.end()
                                     ? named->second
                                     : kinds[static_cast<std::size_t>(dimension)] + std::to_string(number);
        MeshSet& all = mesh.sets[name];
        all.nodes.insert(all.nodes.end(), set.nodes.begin(), set.nodes.end());
        all.faces.insert(all.faces.end(), set.faces.begin(), set.faces.end());
        all.tetrahedra.insert(all.tetrahedra.end(), set.tetrahedra.begin(), set.tetrahedra.end());
    }
    if (mesh.flagged.empty()) return;
    std::unordered_map<std::int64_t, Index> row;
    for (std::size_t t = 0; t < mesh.tags.size(); ++t) row[mesh.tags[t].number] = static_cast<Index>(t);
    for (const auto& [name, members] : mesh.flagged)
        for (const std::int64_t number : members)
            if (const auto found = row.find(number); found != row.end())
                mesh.sets[name].tetrahedra.push_back(found->second);
}

}  // namespace

void read_gmsh_names(FileReader& reader, GmshMesh& mesh) {
    const std::size_t count =
        reader.checked_count(integer_line(reader, 1, "count", "the number of names")[0], 6, "count");
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("name", i + 1, count);
        constexpr const char* expected = "dimension, number and \"name\" of a physical group";
        const std::string_view text = reader.filled_line(expected);
        const std::size_t begin = text.find('"'), end = text.rfind('"');
        if (begin == std::string_view::npos || end == begin) reader.complain({}, in_quotes(text), expected);
        const std::string name(text.substr(begin + 1, end - begin - 1));
        const std::vector<std::string_view>& words = reader.words_of(text.substr(0, begin));
        if (words.size() != 2) reader.complain({}, in_quotes(text), expected);
        const GmshEntity group{reader.parse_integer(words[0], "dimension"), reader.parse_integer(words[1], "number")};
        if (!name.empty()) mesh.group_names[group] = name;
    }
    reader.set_section("$PhysicalNames");
}

void read_gmsh_element_data(FileReader& reader, GmshMesh& mesh) {
    const auto count = [&](const char* meaning) { return integer_line(reader, 1, "count", meaning)[0]; };
    std::string name;
    for (std::int64_t i = count("the number of texts"); i > 0; --i) {
        const std::string_view text = reader.filled_line("a text");
        if (name.empty() && text.size() > 2) name = text.substr(1, text.size() - 2);
    }
    for (std::int64_t i = count("the number of real numbers"); i > 0; --i) reader.filled_line("a real number");
    std::vector<std::int64_t> whole;  // time step, number of components, number of rows
    for (std::int64_t i = count("the number of whole numbers"); i > 0; --i) whole.push_back(count("a whole number"));
    if (whole.size() < 3)
        reader.complain("count", std::to_string(whole.size()) + " whole numbers", "at least 3 whole numbers");
    const std::size_t rows = reader.checked_count(whole[2], 4, "rows");
    std::vector<std::int64_t> members;
    bool is_set = whole[1] == 1 && !name.empty();
    for (std::size_t i = 0; i < rows; ++i) {
        reader.set_row("row", i + 1, rows);
        const std::vector<std::string_view>& words = reader.words_of(reader.filled_line("a number and values"));
        is_set = is_set && words.size() == 2;
        if (!is_set) continue;
        const std::int64_t number = reader.parse_integer(words[0], "number");
        const Real value = reader.parse_real(words[1], "value");
        if (value == 1) members.push_back(number);
        is_set = value == 0 || value == 1;
    }
    if (is_set) mesh.flagged[name] = std::move(members);
    reader.set_section("$ElementData");
}

RawMesh read_gmsh(FileReader& reader) {
    GmshMesh mesh;
    GmshEntities entities;
    NodeNumbers numbers;
    Header header;
    bool has_nodes = false, has_elements = false;
    std::string_view name = reader.filled_line("$MeshFormat or $NOD");
    if (name != "$MeshFormat" && name != "$NOD")
        reader.complain({}, in_quotes(name), "$MeshFormat or $NOD",
                        "a Gmsh file begins with one of these words; check the format of the file");
    if (name == "$MeshFormat")
        header = read_header(reader);
    else
        reader.set_section("$NOD");
    bool first = name == "$NOD";  // true if `name` is the name of a section that has not been read yet
    while (first || !reader.at_end()) {
        if (!first) {
            reader.set_section({});
            name = reader.filled_line("a section");
        }
        first = false;
        if (name.empty() || name.front() != '$') continue;  // text between two sections is ignored, as in Gmsh
        const std::string section(name);
        reader.set_section(section);
        const bool version_1 = header.version == 1;
        if (section == (version_1 ? "$NOD" : "$Nodes")) {
            if (std::exchange(has_nodes, true))
                reader.complain({}, "a second section of nodes", "only one section of nodes");
            header.version == 4 ? read_gmsh4_nodes(reader, header.binary, numbers, mesh)
                                : read_gmsh2_nodes(reader, header.binary, numbers, mesh);
            require_end(reader, version_1 ? "$ENDNOD" : "$EndNodes");
        } else if (section == (version_1 ? "$ELM" : "$Elements")) {
            if (!has_nodes)
                reader.complain({}, "elements before the nodes", "the section of nodes before the section of elements");
            if (std::exchange(has_elements, true))
                reader.complain({}, "a second section of elements", "only one section of elements");
            if (header.version == 4)
                read_gmsh4_elements(reader, header.binary, numbers, entities, mesh);
            else if (header.version == 2)
                read_gmsh2_elements(reader, header.binary, numbers, mesh);
            else
                read_gmsh1_elements(reader, numbers, mesh);
            require_end(reader, version_1 ? "$ENDELM" : "$EndElements");
        } else if (!version_1 && section == "$PhysicalNames") {
            read_gmsh_names(reader, mesh);
            require_end(reader, "$EndPhysicalNames");
        } else if (!version_1 && !header.binary && section == "$ElementData") {
            read_gmsh_element_data(reader, mesh);
            require_end(reader, "$EndElementData");
        } else if (header.version == 4 && section == "$Entities") {
            entities = read_gmsh4_entities(reader, header.binary);
            require_end(reader, "$EndEntities");
        } else {
            const std::string end = (version_1 ? "$END" : "$End") + section.substr(1);
            if (!reader.skip_behind(end))
                reader.complain({}, "no line " + end, end + " at the end of the section",
                                "the file is incomplete; export it again");
        }
    }
    reader.set_section({});
    if (!has_nodes)
        reader.complain({}, "no section of nodes", header.version == 1 ? "a section $NOD" : "a section $Nodes");
    if (!has_elements)
        reader.complain({}, "no section of elements", header.version == 1 ? "a section $ELM" : "a section $Elements");
    label(mesh);
    name_groups(mesh);
    return mesh;
}

}  // namespace skerry::mesh
