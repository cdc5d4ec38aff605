#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "engine/mesh/formats/raw_mesh.h"

// Reader of PLY files, text and binary. It reads the positions and texture coordinates of the element "vertex", and the
// list vertex_indices (or vertex_index) of the element "face". All other elements and properties are skipped. Format:
// G. Turk, "The PLY Polygon File Format", 1994.
namespace skerry::mesh {
namespace {

struct PlyProperty {
    std::string name;
    NumberType type;
    std::optional<NumberType> count_type;  // for a list: type of its entry count, which precedes the entries
};

struct PlyElement {
    std::string name;
    std::int64_t count;
    std::vector<PlyProperty> properties;
};

class PlyReader {
public:
    explicit PlyReader(FileReader& reader) : reader_(reader) {}

    RawMesh read() {
        read_header();
        for (const PlyElement& element : elements_) read_element(element);
        if (!mesh_.visual.texture_points.empty()) mesh_.visual.texture_corners = mesh_.triangles;
        reader_.set_section({});
        return std::move(mesh_);
    }

private:
    void read_header() {
        reader_.set_section("header");
        if (const std::string_view magic = reader_.filled_line("ply"); magic != "ply")
            reader_.complain({}, in_quotes(magic), "ply, the first word of a PLY file");
        bool has_format = false;
        while (true) {
            const std::string_view text = reader_.filled_line("end_header");
            const std::vector<std::string_view>& words = reader_.words_of(text);
            if (words[0] == "end_header") break;
            if (words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "format" && words.size() == 3) {
                read_format(words[1]);
                has_format = true;
            } else if (words[0] == "element" && words.size() == 3) {
                elements_.push_back({std::string(words[1]), reader_.parse_integer(words[2], "count"), {}});
            } else if (words[0] == "property" && !elements_.empty() && words.size() == 3) {
                elements_.back().properties.push_back({std::string(words[2]), type_of(words[1]), {}});
            } else if (words[0] == "property" && !elements_.empty() && words.size() == 5 && words[1] == "list") {
                elements_.back().properties.push_back({std::string(words[4]), type_of(words[3]), type_of(words[2])});
            } else {
                reader_.complain({}, in_quotes(text),
                                 "format NAME 1.0, element NAME COUNT, or after an element: property TYPE NAME or "
                                 "property list TYPE TYPE NAME");
            }
        }
        if (!has_format) reader_.complain({}, "no line format", "format ascii 1.0 or another format");
        const auto vertices = std::ranges::find(elements_, "vertex", &PlyElement::name);
        if (vertices == elements_.end()) reader_.complain({}, "no element vertex", "an element vertex");
        for (const char* axis : axes)
            if (std::ranges::find(vertices->properties, axis, &PlyProperty::name) == vertices->properties.end())
                reader_.complain("vertex", std::string("no property ") + axis, "the properties x, y and z");
        node_count_ = vertices->count;
    }

    void read_format(std::string_view name) {
        if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
            reader_.complain("format", in_quotes(name), "ascii, binary_little_endian or binary_big_endian");
        binary_ = name != "ascii";
        reader_.set_binary(binary_);
        reader_.set_swapped_bytes((name == "binary_little_endian") != (std::endian::native == std::endian::little));
    }

    NumberType type_of(std::string_view name) const {
        struct Name {
            const char *old, *exact;
            NumberType type;
        };
        static constexpr std::array<Name, 8> names{{{"char", "int8", {NumberKind::int8, 1}},
                                                    {"uchar", "uint8", {NumberKind::uint8, 1}},
                                                    {"short", "int16", {NumberKind::int16, 2}},
                                                    {"ushort", "uint16", {NumberKind::uint16, 2}},
                                                    {"int", "int32", {NumberKind::int32, 4}},
                                                    {"uint", "uint32", {NumberKind::uint32, 4}},
                                                    {"float", "float32", {NumberKind::float32, 4}},
                                                    {"double", "float64", {NumberKind::float64, 8}}}};
        const auto found = std::ranges::find_if(names, [&](const Name& n) { return name == n.old || name == n.exact; });
        if (found == names.end())
            reader_.complain("type", in_quotes(name), "a number type of PLY, for example float or uchar");
        return found->type;
    }

    void read_element(const PlyElement& element) {
        reader_.set_section(element.name);
        // Lower limit of the size of a row in the file [bytes]. In text each value needs at least a digit and a
        // separator.
        std::size_t bytes = 0;
        for (const PlyProperty& property : element.properties)
            bytes += binary_ ? (property.count_type ? *property.count_type : property.type).size : 2;
        const std::size_t rows = reader_.checked_count(element.count, std::max<std::size_t>(bytes, 1), "count");
        const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
        const bool has_texture = std::ranges::any_of(
            element.properties, [](const PlyProperty& property) { return texture_axis(property.name) < 2; });
        if (is_vertex) mesh_.nodes.reserve(rows);
        for (std::size_t row = 0; row < rows; ++row) {
            reader_.set_row("row", row + 1, rows);
            Vec3 position = Vec3::Zero();
            std::array<Real, 2> texture{};
            for (const PlyProperty& property : element.properties) {
                const auto axis = std::ranges::find(axes, property.name);
                if (property.count_type)
                    read_list(property, is_face);
                else if (is_vertex && axis != axes.end())
                    position[axis - axes.begin()] = reader_.finite(reader_.real(property.type, "position"), "position");
                else if (is_vertex && texture_axis(property.name) < 2)
                    texture[texture_axis(property.name)] =
                        reader_.finite(reader_.real(property.type, "texture"), "texture");
                else
                    reader_.real(property.type, "number");
            }
            if (!is_vertex) continue;
            mesh_.nodes.push_back(position);
            if (has_texture) mesh_.visual.texture_points.push_back(texture);
        }
        if (element.name == "tristrips" && rows > 0) mesh_.others["triangle strips"] += rows;
    }

    /// Returns 0 or 1 if `name` is the first or second texture coordinate of a vertex, and 2 if it is another property.
    static std::size_t texture_axis(std::string_view name) {
        constexpr std::array<std::string_view, 6> names{"s", "u", "texture_u", "t", "v", "texture_v"};
        const auto found = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
        return found / 3;
    }

    void read_list(const PlyProperty& property, bool is_face) {
        const std::size_t count = reader_.checked_count(reader_.integer(*property.count_type, "entries"),
                                                        binary_ ? property.type.size : 2, "entries");
        const bool is_corners = is_face && (property.name == "vertex_indices" || property.name == "vertex_index");
        corners_.clear();
        for (std::size_t i = 0; i < count; ++i) {
            if (is_corners)
                corners_.push_back(read_node(property.type));
            else
                reader_.real(property.type, "number");
        }
        if (is_corners) add_surface_polygon(corners_, reader_, mesh_);
    }

    Index read_node(const NumberType& type) {
        const std::int64_t node = reader_.integer(type, "node");
        if (node < 0 || node >= node_count_)
            reader_.complain("node", std::to_string(node),
                             "the index of a vertex, 0 to " + std::to_string(node_count_ - 1));
        return static_cast<Index>(node);
    }

    static constexpr std::array<const char*, 3> axes{"x", "y", "z"};

    FileReader& reader_;
    bool binary_ = false;
    std::int64_t node_count_ = 0;
    std::vector<PlyElement> elements_;
    std::vector<Index> corners_;  // node indices of the face that is being read
    RawMesh mesh_;
};

}  // namespace

RawMesh read_ply(FileReader& reader) {
    return PlyReader(reader).read();
}

}  // namespace skerry::mesh
