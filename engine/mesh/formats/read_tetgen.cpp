#include <filesystem>

#include "engine/mesh/formats/raw_mesh.h"

// Reads TetGen's .node, .ele and .face files. Format: TetGen manual, section 5.2.
namespace skerry::mesh {
namespace {

/// Returns the words of the next line that is neither empty nor only a comment. Throws SceneError at the end of the
/// file.
const std::vector<std::string_view>& node_row_words(FileReader& reader, const char* expected) {
    while (!reader.at_end()) {
        const std::string_view text = reader.line();
        const std::vector<std::string_view>& words = reader.words_of(text.substr(0, text.find('#')));
        if (!words.empty()) return words;
    }
    reader.complain({}, "the end of the file", expected, "the file is incomplete; create it again with tetgen");
}

/// Reads the header line, which has one to `most` integers. Missing integers are 0.
std::array<std::int64_t, 4> read_header(FileReader& reader, std::size_t most, const char* meaning) {
    reader.set_section("header");
    const std::vector<std::string_view>& words = node_row_words(reader, meaning);
    if (words.size() > most) reader.complain({}, std::to_string(words.size()) + " numbers", meaning);
    std::array<std::int64_t, 4> numbers{};
    for (std::size_t i = 0; i < words.size(); ++i) numbers[i] = reader.parse_integer(words[i], "number");
    return numbers;
}

void require_end(FileReader& reader, const char* rows) {
    while (!reader.at_end()) {
        const std::string_view text = reader.line();
        if (const std::string_view content = text.substr(0, text.find('#')); !reader.words_of(content).empty())
            reader.complain(
                {}, in_quotes(text), "the end of the file",
                std::string("the file has more ") + rows + " than its header announces; correct the header");
    }
}

void require_words(const FileReader& reader, std::size_t found, std::size_t least, std::size_t most,
                   const char* meaning) {
    if (found < least || found > most)
        reader.complain(
            {}, std::to_string(found) + " numbers",
            (least == most ? std::to_string(least) : std::to_string(least) + " to " + std::to_string(most)) +
                " numbers: " + meaning);
}

/// Name of a temporary set for nodes or faces with the marker 0, which means "not marked". The set is deleted after
/// reading.
constexpr const char* no_marker = "";

/// Returns the set for the marker `word`, and adds it to the mesh if it is new. `kind`: beginning of the name of the
/// set.
MeshSet& add_marked(const FileReader& reader, std::string_view word, const char* kind, RawMesh& mesh) {
    const std::int64_t marker = reader.parse_integer(word, "marker");
    return mesh.sets[marker == 0 ? no_marker : kind + std::to_string(marker)];
}

void read_nodes(FileReader& reader, NodeNumbers& numbers, RawMesh& mesh) {
    const auto [announced, dimension, attributes, markers] = read_header(
        reader, 4, "a header of up to four numbers: count of nodes, dimension, count of attributes, count of markers");
    const std::size_t count = reader.checked_count(announced, 8, "nodes");
    if (dimension != 3 && dimension != 0) reader.complain("dimension", std::to_string(dimension), "3");
    if (attributes < 0 || attributes > 1000) reader.complain("attributes", std::to_string(attributes), "0 to 1000");
    if (markers != 0 && markers != 1) reader.complain("markers", std::to_string(markers), "0 or 1");
    const std::size_t most = 4 + static_cast<std::size_t>(attributes + markers);
    reader.set_section("nodes");
    numbers.reserve(count);
    mesh.nodes.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("node", i + 1, count);
        const std::vector<std::string_view>& words = node_row_words(reader, "number, x, y and z of a node");
        require_words(reader, words.size(), 4, most, "number, x, y, z, attributes and marker of a node");
        const std::int64_t number = reader.parse_integer(words[0], "number");
        // TetGen numbers nodes consecutively from 0 or from 1. Other numbers are accepted too, if no number occurs
        // twice.
        numbers.add(number, reader);
        Vec3 x;
        for (std::size_t a = 0; a < 3; ++a)
            x[static_cast<Eigen::Index>(a)] = reader.finite(reader.parse_real(words[a + 1], "position"), "position");
        if (markers == 1 && words.size() == most)
            add_marked(reader, words.back(), "node_marker_", mesh)
                .nodes.push_back(static_cast<Index>(mesh.nodes.size()));
        mesh.nodes.push_back(x);
    }
    mesh.sets.erase(no_marker);
    require_end(reader, "nodes");
}

/// Conversion of the node order of TetGen: node a in a row of the file .ele has the number tetgen_order[a] in the order
/// of this engine, which is the four corners, then RawMesh::middle.
///
/// With its option -o2 TetGen lists the nodes in the middle of the edges 23, 03, 01, 12, 13 and 20 after the corners
/// (its tables edge2ver, orgpivot and destpivot).
constexpr std::array<std::size_t, 10> tetgen_order{0, 1, 2, 3, 9, 7, 4, 5, 8, 6};

void read_tetrahedra(FileReader& reader, const NodeNumbers& numbers, RawMesh& mesh) {
    const auto [announced, corners, attributes, unused] = read_header(
        reader, 3, "a header of up to three numbers: count of tetrahedra, nodes per tetrahedron, count of attributes");
    (void)unused;
    const std::size_t count = reader.checked_count(announced, 10, "tetrahedra");
    if (corners != 4 && corners != 10 && corners != 0)
        reader.complain("nodes per tetrahedron", std::to_string(corners), "4 or 10");
    const std::size_t node_count = corners == 10 ? 10 : 4;
    if (attributes < 0 || attributes > 1000) reader.complain("attributes", std::to_string(attributes), "0 to 1000");
    reader.set_section("tetrahedra");
    mesh.tetrahedra.reserve(count);
    bool labelled = attributes > 0;
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("tetrahedron", i + 1, count);
        const std::vector<std::string_view>& words = node_row_words(reader, "number and nodes of a tetrahedron");
        require_words(reader, words.size(), 1 + node_count, 1 + node_count + static_cast<std::size_t>(attributes),
                      "number, nodes and attributes of a tetrahedron");
        std::array<Index, 10> nodes{};
        for (std::size_t a = 0; a < node_count; ++a) {
            nodes[tetgen_order[a]] = numbers.row(reader.parse_integer(words[a + 1], "node"), reader);
        }
        take_tetrahedron(std::span(nodes).first(node_count), reader, mesh);
        // with its option -A TetGen writes the number of the region as the last attribute
        labelled = labelled && words.size() == 1 + node_count + static_cast<std::size_t>(attributes);
        if (!labelled) continue;
        const std::optional<int> number = as_label(reader.parse_real(words.back(), "attribute"));
        labelled = number.has_value();
        mesh.label.push_back(number.value_or(0));
    }
    if (!labelled) mesh.label.clear();
    require_end(reader, "tetrahedra");
}

/// Adds a set of faces for each marker of the file .face, except marker 0.
void read_faces(FileReader& reader, const NodeNumbers& numbers, RawMesh& mesh) {
    const auto [announced, markers, none, unused] =
        read_header(reader, 2, "a header of up to two numbers: count of faces, count of markers");
    (void)none, (void)unused;
    const std::size_t count = reader.checked_count(announced, 8, "faces");
    if (markers != 0 && markers != 1) reader.complain("markers", std::to_string(markers), "0 or 1");
    reader.set_section("faces");
    for (std::size_t i = 0; i < count && markers == 1; ++i) {
        reader.set_row("face", i + 1, count);
        const std::vector<std::string_view>& words = node_row_words(reader, "number, nodes and marker of a face");
        // In a mesh of second order, the three nodes in the middle of the edges stand before the marker. With the
        // option -nn TetGen writes the two tetrahedra at the face after the marker.
        require_words(reader, words.size(), 5, 10, "number, three or six nodes, marker and neighbours of a face");
        std::array<Index, 3> nodes;
        for (std::size_t a = 0; a < 3; ++a) nodes[a] = numbers.row(reader.parse_integer(words[a + 1], "node"), reader);
        require_different(nodes, reader);
        add_marked(reader, words[words.size() < 8 ? 4 : 7], "face_marker_", mesh).faces.push_back(nodes);
    }
    mesh.sets.erase(no_marker);
}

}  // namespace

RawMesh read_tetgen(const std::string& path) {
    std::filesystem::path base(path);
    RawMesh mesh;
    NodeNumbers numbers;
    FileReader nodes(base.replace_extension(".node").string());
    read_nodes(nodes, numbers, mesh);
    FileReader elements(base.replace_extension(".ele").string());
    read_tetrahedra(elements, numbers, mesh);
    if (base.replace_extension(".face"); std::filesystem::exists(base)) {
        FileReader faces(base.string());
        read_faces(faces, numbers, mesh);
    }
    return mesh;
}

}  // namespace skerry::mesh
