#include <utility>

#include "engine/mesh/formats/raw_mesh.h"
#include "skerry/surface_check.h"

// Reader of STL files. STL repeats the positions of the corners for each triangle. Equal positions become one node;
// triangles left with fewer than three different nodes are dropped.
namespace skerry::mesh {
namespace {

void add_triangle(const std::array<Vec3, 3>& corners, SurfaceMesh& surface) {
    const auto first = static_cast<Index>(surface.nodes.size());
    surface.nodes.insert(surface.nodes.end(), corners.begin(), corners.end());
    surface.triangles.push_back({first, first + 1, first + 2});
}

constexpr std::size_t header_bytes = 80, triangle_bytes = 50;

void read_binary(FileReader& reader, SurfaceMesh& surface) {
    reader.set_swapped_bytes(std::endian::native == std::endian::big);  // STL files are little-endian
    reader.skip_bytes(header_bytes, "header");
    const std::size_t count = reader.checked_count(reader.binary<std::uint32_t>("count"), triangle_bytes, "count");
    for (std::size_t i = 0; i < count; ++i) {
        reader.set_row("triangle", i + 1, count);
        reader.skip_bytes(12, "normal");
        std::array<Vec3, 3> corners;
        for (Vec3& x : corners)
            for (Real& value : x)
                value = reader.finite(static_cast<Real>(reader.binary<float>("position")), "position");
        reader.skip_bytes(2, "attributes");
        add_triangle(corners, surface);
    }
}

void require_word(FileReader& reader, const char* expected) {
    if (const std::string_view found = reader.word(expected); found != expected)
        reader.complain({}, in_quotes(found), expected);
}

void read_ascii(FileReader& reader, SurfaceMesh& surface) {
    while (!reader.at_end()) {
        reader.set_section("solid");
        const std::vector<std::string_view>& words = reader.words_of(reader.filled_line("solid"));
        if (words[0] != "solid") reader.complain({}, in_quotes(words[0]), "solid");
        for (std::size_t i = 1;; ++i) {
            const std::string_view key = reader.word("facet or endsolid");
            if (key == "endsolid") break;
            reader.set_section("facet " + std::to_string(i));
            if (key != "facet") reader.complain({}, in_quotes(key), "facet or endsolid");
            require_word(reader, "normal");
            // the normal vector is not used, because many files have wrong normals
            for (int a = 0; a < 3; ++a) reader.word("a normal");
            require_word(reader, "outer");
            require_word(reader, "loop");
            std::array<Vec3, 3> corners;
            for (Vec3& x : corners) {
                require_word(reader, "vertex");
                for (Real& value : x)
                    value = reader.finite(reader.parse_real(reader.word("a coordinate"), "position"), "position");
            }
            require_word(reader, "endloop");
            require_word(reader, "endfacet");
            add_triangle(corners, surface);
        }
        reader.line();  // skips the rest of the line, which repeats the name of the solid
    }
}

}  // namespace

RawMesh read_stl(FileReader& reader) {
    SurfaceMesh surface;
    // The header of a binary file may begin with "solid", like a text file. Therefore the file size decides: a binary
    // file with n triangles has exactly 84 + 50 n bytes.
    const std::string_view bytes = reader.rest();
    if (bytes.empty()) reader.complain({}, "an empty file", "an STL file", "export the surface again");
    bool binary = false;
    if (bytes.size() >= header_bytes + 4) {
        std::uint64_t count = 0;
        for (std::size_t i = 4; i-- > 0;) count = 256 * count + static_cast<unsigned char>(bytes[header_bytes + i]);
        binary = bytes.size() == header_bytes + 4 + triangle_bytes * count;
    }
    const bool text = !binary && reader.peek_word() == "solid";
    if (!text && bytes.size() < header_bytes + 4)
        reader.complain({}, std::to_string(bytes.size()) + " bytes that do not begin with \"solid\"",
                        "an STL file: text that begins with \"solid\", or at least 84 bytes",
                        "check that the file is an STL file and complete");
    if (!text)
        read_binary(reader, surface);
    else
        read_ascii(reader, surface);
    reader.set_section({});
    SurfaceMesh welded = weld(surface, 0);
    const std::size_t flat = surface.triangles.size() - welded.triangles.size();
    RawMesh mesh;
    mesh.nodes = std::move(welded.nodes);
    mesh.triangles = std::move(welded.triangles);
    if (flat > 0) mesh.others["flat triangles"] = flat;
    return mesh;
}

}  // namespace skerry::mesh
