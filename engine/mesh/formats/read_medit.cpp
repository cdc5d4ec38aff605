#include <algorithm>
#include <bit>

#include "engine/mesh/formats/raw_mesh.h"

// Reader of Medit meshes, text (.mesh) and binary (.meshb, file versions 1 to 4). It reads vertices, tetrahedra and
// triangles of first and second order with their references. It counts other elements, skips all other sections, and
// refuses tetrahedra of third or higher order.
//
// Format: P. Frey, "Medit: an interactive mesh visualization software", INRIA RT-0253, 2001; L. Marechal, "The libMeshb
// library".
namespace skerry::mesh {
namespace {

enum class MeditContent { vertices, elements, others, order };

struct MeditSection {
    const char* keyword;
    std::int64_t code;  // number of the keyword in a binary file
    MeditContent content;
    std::size_t nodes = 0;       // number of nodes of an element
    const char* kind = nullptr;  // name of elements that are only counted
};
constexpr const char* curved_triangles = "triangles of third or higher order";
constexpr const char* curved_tetrahedra = "tetrahedra of third or higher order";
constexpr MeditSection medit_sections[] = {{"Vertices", 4, MeditContent::vertices},
                                           {"Edges", 5, MeditContent::others, 2, "lines"},
                                           {"Triangles", 6, MeditContent::elements, 3},
                                           {"Quadrilaterals", 7, MeditContent::others, 4, "quadrilaterals"},
                                           {"Tetrahedra", 8, MeditContent::elements, 4},
                                           {"Prisms", 9, MeditContent::others, 6, "prisms"},
                                           {"Hexahedra", 10, MeditContent::others, 8, "hexahedra"},
                                           {"TrianglesP2", 24, MeditContent::elements, 6},
                                           {"EdgesP2", 25, MeditContent::others, 3, "lines"},
                                           {"QuadrilateralsQ2", 27, MeditContent::others, 9, "quadrilaterals"},
                                           {"TetrahedraP2", 30, MeditContent::elements, 10},
                                           {"HexahedraQ2", 33, MeditContent::others, 27, "hexahedra"},
                                           {"Pyramids", 49, MeditContent::others, 5, "pyramids"},
                                           {"PrismsP2", 86, MeditContent::others, 18, "prisms"},
                                           {"PyramidsP2", 87, MeditContent::others, 14, "pyramids"},
                                           {"TrianglesP3", 90, MeditContent::others, 10, curved_triangles},
                                           {"TrianglesP4", 91, MeditContent::others, 15, curved_triangles},
                                           {"TetrahedraP3", 96, MeditContent::others, 20, curved_tetrahedra},
                                           {"TetrahedraP4", 97, MeditContent::others, 35, curved_tetrahedra},
                                           {"TrianglesP2Ordering", 129, MeditContent::order, 6},
                                           {"TetrahedraP2Ordering", 133, MeditContent::order, 10}};
constexpr std::int64_t dimension_code = 3, end_code = 54;

class MeditReader {
public:
    explicit MeditReader(FileReader& reader) : reader_(reader) {}

    RawMesh read() {
        reader_.set_section("header");
        const std::string_view bytes = reader_.rest();
        const bool little = bytes.starts_with(std::string_view("\1\0\0\0", 4));
        binary_ = little || bytes.starts_with(std::string_view("\0\0\0\1", 4));
        reader_.set_binary(binary_);
        reader_.set_swapped_bytes(little != (std::endian::native == std::endian::little));
        binary_ ? read_binary() : read_text();
        reader_.set_section({});
        if (!labelled_) mesh_.label.clear();
        return std::move(mesh_);
    }

private:
    void read_text() {
        if (const std::string_view first = next_word(); first != "MeshVersionFormatted")
            reader_.complain({}, in_quotes(first), "MeshVersionFormatted, the first word of a Medit file");
        reader_.integer(index_type_, "version");
        for (std::string_view keyword = next_word(); !keyword.empty() && keyword != "End"; keyword = next_word()) {
            reader_.set_section(std::string(keyword));
            if (!begins_keyword(keyword))
                reader_.complain({}, in_quotes(keyword), "a keyword",
                                 "if the section above has more rows than its header announces, correct the count");
            const auto* const section = std::ranges::find(medit_sections, keyword, &MeditSection::keyword);
            if (keyword == "Dimension")
                read_dimension();
            else if (section != std::end(medit_sections))
                read_section(*section);
            else
                while (!reader_.at_end() && !begins_keyword(reader_.peek_word())) reader_.word("a number");
        }
    }

    void read_binary() {
        reader_.skip_bytes(4, "byte order");
        const std::int64_t version = reader_.binary<std::int32_t>("version");
        if (version < 1 || version > 4) reader_.complain("version", std::to_string(version), "1 to 4");
        constexpr NumberType wide{NumberKind::int64, 8};
        const NumberType place_type = version >= 3 ? wide : index_type_;
        if (version == 4) index_type_ = wide;
        if (version == 1) real_type_ = {NumberKind::float32, 4};
        while (reader_.remaining() > 0) {
            reader_.set_section("keyword");
            const std::int64_t code = reader_.binary<std::int32_t>("number of the keyword");
            const std::int64_t next = reader_.integer(place_type, "position of the next keyword");
            if (code == end_code) return;
            const auto* const section = std::ranges::find(medit_sections, code, &MeditSection::code);
            if (code == dimension_code)
                read_dimension();
            else if (section != std::end(medit_sections))
                read_section(*section);
            if (next == 0) return;
            if (next < static_cast<std::int64_t>(reader_.position()))
                reader_.complain("position of the next keyword", std::to_string(next),
                                 "at least " + std::to_string(reader_.position()) + ", the end of this section");
            reader_.go_to(static_cast<std::size_t>(next));
        }
    }

    static bool begins_keyword(std::string_view word) {
        return (word.front() >= 'A' && word.front() <= 'Z') || (word.front() >= 'a' && word.front() <= 'z');
    }

    /// Returns the next word of a text file outside of comments; empty at the end of the file.
    std::string_view next_word() {
        skip_comments();
        return reader_.at_end() ? std::string_view() : reader_.word("a keyword");
    }

    void skip_comments() {
        while (!binary_ && reader_.peek_word().starts_with('#')) reader_.filled_line("a comment");
    }

    void read_dimension() {
        const std::int64_t dimension = reader_.integer({NumberKind::int32, 4}, "dimension");
        if (dimension != 3) reader_.complain("dimension", std::to_string(dimension), "3");
    }

    void read_section(const MeditSection& section) {
        reader_.set_section(section.keyword);
        skip_comments();
        const bool vertices = section.content == MeditContent::vertices;
        const std::size_t numbers = vertices ? 4 : section.nodes + 1,
                          bytes = vertices ? 3 * real_type_.size + index_type_.size : numbers * index_type_.size;
        const std::size_t count =
            reader_.checked_count(reader_.integer(index_type_, "count"), binary_ ? bytes : 2 * numbers, "count");
        if (count == 0) return;
        switch (section.content) {
            case MeditContent::vertices:
                read_vertices(count);
                break;
            case MeditContent::elements:
                read_elements(section, count);
                break;
            case MeditContent::others:
                if (section.kind == curved_tetrahedra)
                    reader_.complain({}, std::to_string(count) + " " + curved_tetrahedra,
                                     "tetrahedra of first or second order", "export the mesh with linear elements");
                mesh_.others[section.kind] += count;
                mesh_.curved_triangles += section.kind == curved_triangles ? count : 0;
                for (std::size_t i = 0; i < numbers * count; ++i) reader_.integer(index_type_, "node");
                break;
            case MeditContent::order:
                require_order(section.nodes, count);
                break;
        }
    }

    void read_vertices(std::size_t count) {
        if (!mesh_.nodes.empty()) reader_.complain({}, "a second section Vertices", "only one section Vertices");
        mesh_.nodes.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            reader_.set_row("row", i + 1, count);
            Vec3 x;
            for (Real& value : x) value = reader_.finite(reader_.real(real_type_, "position"), "position");
            const std::int64_t reference = reader_.integer(index_type_, "reference");
            if (reference != 0)
                mesh_.sets["node_ref_" + std::to_string(reference)].nodes.push_back(static_cast<Index>(i));
            mesh_.nodes.push_back(x);
        }
    }

    void read_elements(const MeditSection& section, std::size_t count) {
        std::vector<Index> nodes(section.nodes);
        const bool tetrahedra = section.nodes == 4 || section.nodes == 10;
        for (std::size_t i = 0; i < count; ++i) {
            reader_.set_row("row", i + 1, count);
            for (Index& node : nodes) node = read_node();
            const std::int64_t reference = reader_.integer(index_type_, "reference");
            if (tetrahedra) {
                take_tetrahedron(nodes, reader_, mesh_);
                const std::optional<int> label = as_label(static_cast<Real>(reference));
                labelled_ = labelled_ && label;
                mesh_.label.push_back(label.value_or(0));
            } else {
                take_triangle(nodes, reader_, mesh_);
                if (reference != 0)
                    mesh_.sets["face_ref_" + std::to_string(reference)].faces.push_back(mesh_.triangles.back());
            }
        }
    }

    Index read_node() {
        const std::int64_t number = reader_.integer(index_type_, "node");
        const auto count = static_cast<std::int64_t>(mesh_.nodes.size());
        if (number < 1 || number > count)
            reader_.complain("node", std::to_string(number),
                             "1 to " + std::to_string(count) + ", the number of a vertex that is defined above");
        return static_cast<Index>(number - 1);
    }

    /// Checks that the nodes of second-order elements have the order of RawMesh::middle. Each row of the section
    /// describes one node by its barycentric coordinates times two, which are integers.
    void require_order(std::size_t nodes, std::size_t count) {
        const std::size_t corners = nodes == 10 ? 4 : 3;
        for (std::size_t i = 0; i < count; ++i) {
            reader_.set_row("row", i + 1, count);
            const std::array<std::size_t, 2> ends =
                i < corners ? std::array{i, i} : second_order_edges[std::min(i, nodes - 1) - corners];
            for (std::size_t k = 0; k < corners; ++k) {
                const std::int64_t expected = (ends[0] == k ? 1 : 0) + (ends[1] == k ? 1 : 0);
                if (const std::int64_t found = reader_.integer(index_type_, "coordinate"); found != expected)
                    reader_.complain("coordinate", std::to_string(found), std::to_string(expected),
                                     "the nodes must be the corners, then the middles of the edges 12, 23, 31, 14, 24 "
                                     "and 34");
            }
        }
    }

    FileReader& reader_;
    bool binary_ = false, labelled_ = true;
    NumberType index_type_{NumberKind::int32, 4}, real_type_{NumberKind::float64, 8};
    RawMesh mesh_;
};

}  // namespace

RawMesh read_medit(FileReader& reader) {
    return MeditReader(reader).read();
}

}  // namespace skerry::mesh
