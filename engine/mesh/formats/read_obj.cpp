#include <algorithm>
#include <filesystem>

#include "engine/mesh/formats/raw_mesh.h"

// Readers of Wavefront .obj files and of their .mtl files. In an .obj file they read the lines "v x y z" (node),
// "vt u v" (texture coordinates), "f a b c ..." (face), "usemtl NAME" and "mtllib FILE". All other lines are ignored.
namespace skerry::mesh {
namespace {

/// Reads the number of a node or of a texture point, and returns its index. `rows`: number of nodes or texture points
/// defined so far. The number 1 means the first of them, -1 the last.
Index parse_number(const FileReader& reader, std::string_view text, const char* field, std::size_t rows) {
    const std::int64_t number = reader.parse_integer(text, field);
    const auto count = static_cast<std::int64_t>(rows);
    const std::int64_t row = number < 0 ? count + number : number - 1;
    if (count == 0)
        reader.complain(field, std::to_string(number), std::string("a ") + field + " defined above, but there is none");
    if (row < 0 || row >= count)
        reader.complain(field, std::to_string(number),
                        "1 to " + std::to_string(count) + " (the " + field + "s defined above), or -1 to -" +
                            std::to_string(count) + " to count back from the last " + field);
    return static_cast<Index>(row);
}

/// Text of the number of the texture point in a corner such as "7/2/3": the part between the first and second slash.
std::string_view texture_part(std::string_view corner) {
    const std::size_t slash = corner.find('/');
    if (slash == std::string_view::npos) return {};
    corner.remove_prefix(slash + 1);
    return corner.substr(0, corner.find('/'));
}

/// Reads the `N` numbers after the first word (the key) of a line.
template <std::size_t N>
std::array<Real, N> parse_reals(const FileReader& reader, const std::vector<std::string_view>& words, const char* field,
                                const char* noun) {
    if (words.size() <= N)
        reader.complain({}, std::to_string(words.size() - 1) + " " + noun,
                        "at least " + std::to_string(N) + " " + noun);
    std::array<Real, N> values;
    for (std::size_t a = 0; a < N; ++a) values[a] = reader.finite(reader.parse_real(words[a + 1], field), field);
    return values;
}

/// Text of a line after its first word `key`. It may contain spaces, for example in the name of a file.
std::string rest_of(std::string_view line, std::string_view key) {
    line.remove_prefix(key.size());
    const std::size_t begin = line.find_first_not_of(" \t");
    return begin == std::string_view::npos ? std::string() : std::string(line.substr(begin));
}

/// Returns the index of a material, which is appended if it is new.
Index material_row(const std::string& name, std::vector<VisualMaterial>& materials) {
    const auto known = std::ranges::find(materials, name, &VisualMaterial::name);
    const auto row = static_cast<Index>(known - materials.begin());
    if (known == materials.end()) materials.push_back({.name = name});
    return row;
}

void read_face(const FileReader& reader, const std::vector<std::string_view>& words, Index material, RawMesh& mesh) {
    if (words.size() < 4) reader.complain({}, std::to_string(words.size() - 1) + " corners", "at least 3 corners");
    VisualSurface& visual = mesh.visual;
    std::vector<Index> corners, texture;
    for (std::size_t i = 1; i < words.size(); ++i) {
        corners.push_back(parse_number(reader, words[i].substr(0, words[i].find('/')), "node", mesh.nodes.size()));
        // Some files number texture points without defining any. These numbers are ignored.
        if (const std::string_view part = texture_part(words[i]); !part.empty() && !visual.texture_points.empty())
            texture.push_back(parse_number(reader, part, "texture point", visual.texture_points.size()));
    }
    if (texture.size() < corners.size()) texture.assign(corners.size(), no_index);
    for (const std::size_t i : add_surface_polygon(corners, reader, mesh)) {
        visual.texture_corners.push_back({texture[0], texture[i], texture[i + 1]});
        visual.material.push_back(material);
    }
}

}  // namespace

RawMesh read_obj(FileReader& reader) {
    RawMesh mesh;
    Index material = no_index;
    while (!reader.at_end()) {
        const std::string_view line = reader.filled_line("a line");
        const std::vector<std::string_view>& words = reader.words_of(line);
        if (words[0] == "v") {
            reader.set_section("node " + std::to_string(mesh.nodes.size() + 1));
            const std::array<Real, 3> x = parse_reals<3>(reader, words, "position", "coordinates");
            mesh.nodes.emplace_back(x[0], x[1], x[2]);
        } else if (words[0] == "vt") {
            reader.set_section("texture point " + std::to_string(mesh.visual.texture_points.size() + 1));
            mesh.visual.texture_points.push_back(
                parse_reals<2>(reader, words, "texture coordinate", "texture coordinates"));
        } else if (words[0] == "f") {
            reader.set_section("face");
            read_face(reader, words, material, mesh);
        } else if (words[0] == "usemtl") {
            material = material_row(rest_of(line, words[0]), mesh.visual.materials);
        } else if (words[0] == "mtllib") {
            mesh.material_files.push_back(rest_of(line, words[0]));
        }
    }
    reader.set_section({});
    if (mesh.visual.texture_points.empty()) mesh.visual.texture_corners.clear();
    if (mesh.visual.materials.empty()) mesh.visual.material.clear();
    return mesh;
}

std::vector<VisualMaterial> read_mtl(FileReader& reader) {
    std::vector<VisualMaterial> materials;
    while (!reader.at_end()) {
        const std::string_view line = reader.filled_line("a line");
        const std::vector<std::string_view>& words = reader.words_of(line);
        const std::string_view key = words[0];
        if (key == "newmtl") {
            materials.push_back({.name = rest_of(line, key)});
            reader.set_section("material '" + materials.back().name + "'");
        }
        if (materials.empty()) continue;
        VisualMaterial& material = materials.back();
        if (key == "Kd" && words.size() > 1 && words[1] != "spectral" && words[1] != "xyz")
            for (std::size_t k = 0; k < 3; ++k)
                material.color[k] = std::clamp<Real>(parse_reals<3>(reader, words, "Kd", "numbers")[k], 0, 1);
        if (key == "d" && words.size() == 2)
            material.opacity = std::clamp<Real>(parse_reals<1>(reader, words, "d", "numbers")[0], 0, 1);
        if (key == "Tr") {
            // Some programs write the opacity here, usually 1. As a transparency, 1 would make the surface invisible,
            // so it is ignored.
            const Real transparency = parse_reals<1>(reader, words, "Tr", "numbers")[0];
            if (transparency < 1) material.opacity = std::clamp<Real>(1 - transparency, 0, 1);
        }
        if (key == "map_Kd") {
            // Options such as "-s 1 1 1" may precede the name of the file, which is then the last word.
            const std::string file =
                words.size() > 1 && words[1].front() == '-' ? std::string(words.back()) : rest_of(line, key);
            if (!file.empty()) material.texture = (std::filesystem::path(reader.path()).parent_path() / file).string();
        }
    }
    return materials;
}

}  // namespace skerry::mesh
