#include "engine/mesh/formats/raw_mesh.h"

// Reader of Wavefront .obj files. It reads the lines "v x y z" (node) and "f a b c ..." (face). All other lines
// (normals, texture, groups, materials, lines) are ignored.
namespace skerry::mesh {
namespace {

/// Reads a corner of a face, such as "7", "7/2" or "7//3", where the number before the first slash is the node.
/// Negative numbers count from the last node read so far, which is -1.
Index parse_corner(const FileReader& reader, std::string_view word, std::size_t node_count) {
    const std::int64_t number = reader.parse_integer(word.substr(0, word.find('/')), "node");
    const auto count = static_cast<std::int64_t>(node_count);
    const std::int64_t row = number < 0 ? count + number : number - 1;
    if (row < 0 || row >= count)
        reader.complain("node", std::to_string(number),
                        "1 to " + std::to_string(count) + " (the nodes defined above), or -1 to -" +
                            std::to_string(count) + " to count back from the last node");
    return static_cast<Index>(row);
}

}  // namespace

RawMesh read_obj(FileReader& reader) {
    RawMesh mesh;
    std::vector<Index> corners;
    while (!reader.at_end()) {
        const std::vector<std::string_view>& words = reader.words_of(reader.filled_line("a line"));
        if (words[0] == "v") {
            reader.set_section("node " + std::to_string(mesh.nodes.size() + 1));
            if (words.size() < 4)
                reader.complain({}, std::to_string(words.size() - 1) + " coordinates", "at least 3 coordinates");
            Vec3 x;
            for (std::size_t a = 0; a < 3; ++a)
                x[static_cast<Eigen::Index>(a)] =
                    reader.finite(reader.parse_real(words[a + 1], "position"), "position");
            mesh.nodes.push_back(x);
        } else if (words[0] == "f") {
            reader.set_section("face");
            if (words.size() < 4)
                reader.complain({}, std::to_string(words.size() - 1) + " corners", "at least 3 corners");
            corners.clear();
            for (std::size_t i = 1; i < words.size(); ++i)
                corners.push_back(parse_corner(reader, words[i], mesh.nodes.size()));
            add_polygon(corners, reader, mesh);
        }
    }
    reader.set_section({});
    return mesh;
}

}  // namespace skerry::mesh
