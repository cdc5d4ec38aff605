// Writes the present state of a world as binary glTF 2.0.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/write_file.h"
#include "engine/output/collect_frame.h"
#include "engine/output/film/drawn_surface.h"
#include "engine/output/json_object.h"
#include "engine/output/shape_picture.h"
#include "skerry/output.h"
#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

// Constants of glTF: types of components, and uses (targets) of buffer views.
constexpr int type_float = 5126, type_uint32 = 5125, target_vertices = 34962, target_indices = 34963;

/// A surface with values at its vertices. A vertex x of `points` has the position origin + rotation x.
struct GltfMesh {
    std::string name;
    Vec3 origin = Vec3::Zero();  // [m]
    Mat3 rotation = Mat3::Identity();
    std::vector<Vec3f> points;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<float> values;              // values of the coloured quantity by vertex; empty if there is none
    const VisualSurface* visual = nullptr;  // surface with texture coordinates and materials; nullptr if there is none
    Color color{};                          // colour of triangles without a material or values
};

/// Unit normal at each vertex: mean of the normals of its triangles, weighted by area.
std::vector<Vec3f> vertex_normals(const GltfMesh& mesh) {
    const auto point = [&](Index vertex) {
        return Eigen::Vector3f(mesh.points[static_cast<std::size_t>(vertex)].data());
    };
    std::vector<Eigen::Vector3f> sum(mesh.points.size(), Eigen::Vector3f::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3f area = (point(b) - point(a)).cross(point(c) - point(a));
        for (const Index corner : {a, b, c}) sum[static_cast<std::size_t>(corner)] += area;
    }
    std::vector<Vec3f> normals;
    for (const Eigen::Vector3f& total : sum) {
        // glTF requires unit vectors. A vertex at which all triangles are flat gets an arbitrary one.
        const Eigen::Vector3f unit =
            total.norm() > 0 ? Eigen::Vector3f(total / total.norm()) : Eigen::Vector3f::UnitZ();
        normals.push_back({unit.x(), unit.y(), unit.z()});
    }
    return normals;
}

class GltfFile {
public:
    GltfFile(FilmColor color, Real top) : color_(color), top_(top) {
        json_ = object_of(
            {{"asset", object_of({{"version", "2.0"}, {"generator", "Skerry"}})},
             {"scene", 0},
             {"scenes", Json::array({object_of({{"nodes", {0}}})})},
             {"nodes",
              Json::array({object_of({{"name", "World"}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}})})}});
    }

    void add(const GltfMesh& mesh) {
        if (mesh.triangles.empty()) return;
        const Eigen::Quaternion<Real> turn(mesh.rotation);
        const std::size_t number = append("meshes", object_of({{"name", mesh.name}, {"primitives", primitives(mesh)}}));
        const std::size_t node =
            append("nodes", object_of({{"name", mesh.name},
                                       {"mesh", number},
                                       {"translation", {mesh.origin.x(), mesh.origin.y(), mesh.origin.z()}},
                                       {"rotation", {turn.x(), turn.y(), turn.z(), turn.w()}}}));
        json_["nodes"][0]["children"].push_back(node);
    }

    void write(const std::filesystem::path& file) {
        pad(binary_, '\0');
        if (!binary_.empty()) append("buffers", object_of({{"byteLength", binary_.size()}}));
        std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
        pad(text, ' ');
        constexpr std::uint32_t magic = 0x46546c67, version = 2, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
        constexpr std::size_t headers = 12 + 8 + 8;
        write_file(file, [&](std::ostream& out) {
            const auto put = [&](std::initializer_list<std::size_t> numbers) {
                for (const std::size_t number : numbers) {
                    const auto value = static_cast<std::uint32_t>(number);
                    out.write(reinterpret_cast<const char*>(&value), sizeof value);
                }
            };
            put({magic, version, headers + text.size() + binary_.size(), text.size(), json_chunk});
            out << text;
            put({binary_.size(), binary_chunk});
            out << binary_;
        });
    }

private:
    static void pad(std::string& bytes, char with) { bytes.append((4 - bytes.size() % 4) % 4, with); }

    /// Appends an object to the JSON array `list` of the file, and returns its index there.
    std::size_t append(const char* list, Json object) {
        json_[list].push_back(std::move(object));
        return json_[list].size() - 1;
    }

    /// Appends bytes to the binary part, and returns the index of the new buffer view. `target`: target_vertices,
    /// target_indices, or 0 for other data.
    std::size_t view(std::string_view bytes, int target) {
        pad(binary_, '\0');
        Json view = object_of({{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}});
        if (target != 0) view["target"] = target;
        binary_.append(bytes);
        return append("bufferViews", std::move(view));
    }

    /// Appends an array with a new buffer view and accessor, and returns the index of the accessor.
    template <class T>
    std::size_t array(const std::vector<T>& values, const char* type, int component, int target) {
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        return append("accessors", object_of({{"bufferView", view(bytes, target)},
                                              {"componentType", component},
                                              {"count", values.size()},
                                              {"type", type}}));
    }

    Json primitives(const GltfMesh& mesh) {
        const bool textured = mesh.visual != nullptr && !mesh.visual->texture_corners.empty();
        VisualPoints vertices{.node = std::vector<Index>(mesh.points.size()), .texture_point = {}};
        if (textured) {
            vertices = split_at_seams(*mesh.visual);  // because a vertex of glTF has only one texture point
        } else {
            std::iota(vertices.node.begin(), vertices.node.end(), 0);
            vertices.triangles = mesh.triangles;
        }
        std::map<Index, std::vector<std::uint32_t>> corners;  // corners of the triangles of each material
        for (std::size_t t = 0; t < vertices.triangles.size(); ++t)
            for (const Index corner : vertices.triangles[t])
                corners[material_of(mesh, t)].push_back(static_cast<std::uint32_t>(corner));
        const auto expanded = [&](const auto& values) {
            std::decay_t<decltype(values)> all;
            for (const Index node : vertices.node) all.push_back(values[static_cast<std::size_t>(node)]);
            return all;
        };
        const std::vector<Vec3f> points = expanded(mesh.points);
        Json attributes =
            object_of({{"POSITION", array(points, "VEC3", type_float, target_vertices)},
                       {"NORMAL", array(expanded(vertex_normals(mesh)), "VEC3", type_float, target_vertices)}});
        Vec3f lower = points.front(), upper = lower;
        for (const Vec3f& point : points)
            for (std::size_t axis = 0; axis < point.size(); ++axis) {
                lower[axis] = std::min(lower[axis], point[axis]);
                upper[axis] = std::max(upper[axis], point[axis]);
            }
        Json& accessor = json_["accessors"][attributes["POSITION"].get<std::size_t>()];
        accessor["min"] = lower;
        accessor["max"] = upper;
        if (textured) {
            std::vector<std::array<float, 2>> texture_points;
            for (const Index texture : vertices.texture_point) {
                const std::array<Real, 2> at = texture == no_index
                                                   ? std::array<Real, 2>{}
                                                   : mesh.visual->texture_points[static_cast<std::size_t>(texture)];
                texture_points.push_back({static_cast<float>(at[0]), static_cast<float>(1 - at[1])});
            }
            attributes["TEXCOORD_0"] = array(texture_points, "VEC2", type_float, target_vertices);
        }
        if (!mesh.values.empty()) {
            const std::vector<float> values = expanded(mesh.values);
            std::vector<Color> colors;
            for (const float value : values) colors.push_back(color_of_value(value, top_));
            attributes["COLOR_0"] = array(colors, "VEC3", type_float, target_vertices);
            attributes[attribute_name()] = array(values, "SCALAR", type_float, target_vertices);
        }
        Json all = Json::array();
        for (const auto& [material, indices] : corners)
            all.push_back(object_of({{"attributes", attributes},
                                     {"indices", array(indices, "SCALAR", type_uint32, target_indices)},
                                     {"material", material_number(mesh, material)}}));
        return all;
    }

    /// Material of a triangle: index in VisualSurface::materials, or no_index if the surface has no materials or shows
    /// values.
    Index material_of(const GltfMesh& mesh, std::size_t triangle) const {
        const bool has_materials = mesh.visual != nullptr && !mesh.visual->material.empty() && mesh.values.empty();
        return has_materials ? mesh.visual->material[triangle] : no_index;
    }

    /// Name of the vertex attribute of the coloured quantity. In glTF, names of additional attributes must begin with
    /// an underscore; upper case is usual.
    std::string attribute_name() const {
        std::string name = std::string("_") + quantity_of(color_).name;
        std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
        return name;
    }

    std::size_t material_number(const GltfMesh& mesh, Index material) {
        VisualMaterial shown{.name = "vertex_color", .color = {1, 1, 1}};
        if (mesh.values.empty()) shown = {.name = mesh.name, .color = {mesh.color[0], mesh.color[1], mesh.color[2]}};
        if (material != no_index) {
            shown = mesh.visual->materials[static_cast<std::size_t>(material)];
            const Color color = color_of_material(shown);
            shown.color = {color[0], color[1], color[2]};
        }
        const auto known = std::ranges::find(materials_, shown);
        if (known != materials_.end()) return static_cast<std::size_t>(known - materials_.begin());
        const auto& [r, g, b] = shown.color;
        Json surface =
            object_of({{"baseColorFactor", {r, g, b, shown.opacity}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}});
        if (const std::optional<std::size_t> texture = texture_number(shown.texture)) {
            surface["baseColorTexture"] = object_of({{"index", *texture}});
            surface["baseColorFactor"] = {1, 1, 1, shown.opacity};
        }
        Json entry = object_of({{"name", shown.name}, {"pbrMetallicRoughness", surface}});
        if (shown.opacity < 1) entry["alphaMode"] = "BLEND";
        materials_.push_back(std::move(shown));
        return append("materials", std::move(entry));
    }

    /// Appends an image to the file, and returns the number of its texture. Returns nullopt if the file is not a PNG or
    /// JPEG image; glTF allows only these two.
    std::optional<std::size_t> texture_number(const std::filesystem::path& image) {
        std::ifstream in(image, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        const bool is_png = bytes.starts_with("\x89PNG");
        if (!is_png && !bytes.starts_with("\xff\xd8")) return std::nullopt;
        const std::size_t number = append(
            "images", object_of({{"bufferView", view(bytes, 0)}, {"mimeType", is_png ? "image/png" : "image/jpeg"}}));
        return append("textures", object_of({{"source", number}}));
    }

    FilmColor color_;
    Real top_;  // value at the upper end of the colours
    Json json_;
    std::string binary_;
    std::vector<VisualMaterial> materials_;
};

}  // namespace

void require_gltf() {}

void write_gltf(const World& world, const std::filesystem::path& file, FilmColor color, std::optional<Real> color_max) {
    require_extension(file, {".glb"});
    if (color_max) require_positive(file, "color_max", *color_max);
    const Frame frame = collect_frame(world, content_of(color));
    std::vector<std::vector<Real>> quantity(frame.bodies.size());
    if (color != FilmColor::none) quantity = quantity_of_nodes(frame, color);
    std::vector<GltfMesh> meshes;
    Quantile values;
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
        const BodyFrame& body = frame.bodies[b];
        const DrawnSurface surface(body);
        const std::vector<Vec3> points = surface.vectors(body, body.position);
        GltfMesh& mesh = meshes.emplace_back();
        mesh.name = body.name;
        mesh.origin = mean_of(points);
        mesh.points = relative_to(mesh.origin, points);
        mesh.triangles = surface.triangles();
        mesh.color = color_of_body(b);
        if (body.visual != nullptr) mesh.visual = &body.visual->surface;
        if (quantity[b].empty()) continue;
        for (const Real value : surface.values(body, quantity[b], color)) {
            mesh.values.push_back(static_cast<float>(value));
            values.add(value);
        }
    }
    const PlanePatch patch = patch_around(frame.bodies).value_or(PlanePatch{});
    for (const ColliderFrame& collider : frame.colliders) {
        const SurfaceMesh picture =
            shape_picture(*collider.shape, {to_shape(collider.pose, patch.center), patch.half_size});
        meshes.push_back({.name = collider.name,
                          .origin = collider.pose.position,
                          .rotation = rotation_matrix(collider.pose.rotation),
                          .points = relative_to(Vec3::Zero(), picture.nodes),
                          .triangles = picture.triangles,
                          .values = {},
                          .color = color_of_colliders()});
    }
    GltfFile gltf(color, color_max.value_or(usual_top(values)));
    for (const GltfMesh& mesh : meshes) gltf.add(mesh);
    gltf.write(file);
}

}  // namespace skerry
