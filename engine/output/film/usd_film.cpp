#include "engine/output/film/usd_film.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

constexpr const char *looks_path = "/World/Looks/", *vertex_color_path = "/World/Looks/vertex_color";
using Vec2f = std::array<float, 2>;

/// Returns a name in the form that USD allows: other characters than letters and digits become underscores, and an
/// underscore is put before a digit at the beginning.
std::string identifier(std::string_view name) {
    std::string text;
    for (const char c : name) {
        const bool is_digit = c >= '0' && c <= '9';
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (is_digit && text.empty()) text += '_';
        text += is_digit || is_letter ? c : '_';
    }
    return text;
}

}  // namespace

UsdFilm::UsdFilm(std::iostream& file, std::filesystem::path folder, const FilmSettings& settings)
    : file_(file), folder_(std::move(folder)), settings_(settings), names_{"Looks", "vertex_color"} {}

/// Returns a valid name that no other prim has, made from `name` or, if it is empty, from `name_if_empty`.
std::string UsdFilm::unique_name(std::string_view name, std::string_view name_if_empty) {
    const std::string base = identifier(name.empty() ? name_if_empty : name);
    std::string unique = base;
    for (int number = 1; !names_.insert(unique).second; ++number) unique = base + "_" + std::to_string(number);
    return unique;
}

UsdFilm::Object& UsdFilm::add_object(std::string_view name, std::string_view name_if_empty) {
    Object& object = objects_.emplace_back();
    object.name = unique_name(name, name_if_empty);
    object.first = times_.size();
    return object;
}

void UsdFilm::put_triangles(Object& object, std::span<const std::array<Index, 3>> triangles) {
    const std::vector<std::int32_t> counts(triangles.size(), 3);
    std::vector<std::int32_t> corners;
    for (const auto& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const auto integers = [&](const std::vector<std::int32_t>& values) {
        return file_.array(CrateType::int32, std::span<const std::int32_t>(values));
    };
    object.mesh.push_back(attribute("faceVertexCounts", "int[]", integers(counts)));
    object.mesh.push_back(attribute("faceVertexIndices", "int[]", integers(corners)));
}

/// Appends a value to a track. A value equal to the previous one is not written again. `content`: elements of the value
/// if it is an array (`is_array`), else the value as the only element.
template <class T>
void UsdFilm::put(Track& track, std::span<const T> content, CrateType type, bool is_array) {
    const std::span<const std::byte> bytes = std::as_bytes(content);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!track.values.empty() && track.bytes == text) {
        track.values.push_back(track.values.back());
        return;
    }
    track.bytes = text;
    track.values.push_back(is_array ? file_.array(type, content) : file_.scalar(type, content.front()));
}

void UsdFilm::put_pose(Object& object, const Vec3& position, const Mat3& rotation) {
    const Eigen::Quaternionf turn = Eigen::Quaternion<Real>(rotation).cast<float>();
    put(object.translate, std::span(&position, 1), CrateType::vec3_double, false);
    put(object.orient, std::span(&turn, 1), CrateType::quaternion_float, false);
}

void UsdFilm::put_points(Object& object, std::span<const Vec3f> points) {
    std::array<Vec3f, 2> extent{Vec3f{}, Vec3f{}};
    if (!points.empty()) extent = {points[0], points[0]};
    for (const Vec3f& point : points)
        for (std::size_t axis = 0; axis < point.size(); ++axis) {
            extent[0][axis] = std::min(extent[0][axis], point[axis]);
            extent[1][axis] = std::max(extent[1][axis], point[axis]);
        }
    put(object.points, points, CrateType::vec3_float, true);
    put(object.extent, std::span<const Vec3f>(extent), CrateType::vec3_float, true);
}

/// Writes the vertices of a rigid body in body coordinates. A later frame of the film replaces them only if the shape
/// has changed: a vertex has moved in body coordinates by more than rounding errors.
void UsdFilm::put_rigid_body(Object& object, const MotionKey& pose, std::span<const Vec3> points) {
    // largest difference that counts as rounding error of a float, as a fraction of the radius of the body
    constexpr Real tolerance = 1e-7;
    const Mat3 rotation = rotation_matrix(pose.rotation);
    if (object.rigid_points.empty()) object.center = rotation.transpose() * (mean_of(points) - pose.position);
    const Vec3 origin = pose.position + rotation * object.center;
    Real radius = 0, moved = infinity;
    std::vector<Vec3> local;
    for (const Vec3& point : points) {
        local.push_back(rotation.transpose() * (point - origin));
        radius = std::max(radius, local.back().norm());
    }
    if (!object.rigid_points.empty()) {
        moved = 0;
        for (std::size_t i = 0; i < local.size(); ++i)
            moved = std::max(moved, (local[i] - object.rigid_points[i]).norm());
    }
    if (!(moved <= tolerance * radius)) object.rigid_points = std::move(local);
    put_pose(object, origin, rotation);
    put_points(object, relative_to(Vec3::Zero(), object.rigid_points));
    const std::vector<Vec3f> at_rest(points.size(), Vec3f{});
    put(object.velocities, std::span<const Vec3f>(at_rest), CrateType::vec3_float, true);
}

void UsdFilm::put_body(const BodyFrame& body, std::span<const Real> quantity) {
    const auto [known, is_new] = body_object_.try_emplace(body.handle, objects_.size());
    if (is_new || !objects_[known->second].surface->is_drawn(body)) {
        known->second = objects_.size();
        Object& added = add_object(body.name, "body");
        added.surface.emplace(body);
        put_triangles(added, added.surface->triangles());
        if (body.visual != nullptr && settings_.color == FilmColor::none) put_materials(added, body.visual->surface);
    }
    Object& object = objects_[known->second];
    const DrawnSurface& surface = *object.surface;
    const std::vector<Vec3> points = surface.vectors(body, body.position);
    if (body.rigid_pose) {
        put_rigid_body(object, *body.rigid_pose, points);
    } else {
        const std::vector<Vec3> velocities = surface.vectors(body, body.velocity);
        const Vec3 origin = mean_of(points);
        object.rigid_points.clear();
        put_pose(object, origin, Mat3::Identity());
        put_points(object, relative_to(origin, points));
        // The transform of the prim already moves with the mean velocity, so only differences from this mean are
        // written.
        const std::vector<Vec3f> relative = relative_to(mean_of(velocities), velocities);
        put(object.velocities, std::span<const Vec3f>(relative), CrateType::vec3_float, true);
    }
    if (!quantity.empty()) {
        std::vector<float> values;
        for (const Real value : surface.values(body, quantity, settings_.color)) {
            values.push_back(static_cast<float>(value));
            quantity_.add(value);
        }
        put(object.quantity, std::span<const float>(values), CrateType::float32, true);
    }
    ++object.frames;
}

void UsdFilm::put_collider(const ColliderFrame& collider) {
    const auto [known, is_new] = collider_object_.try_emplace(collider.handle, objects_.size());
    if (is_new) {
        PlanePatch patch = patch_.value_or(PlanePatch{});
        patch.center = to_shape(collider.pose, patch.center);
        const SurfaceMesh picture = shape_picture(*collider.shape, patch);
        Object& added = add_object(collider.name, "collider");
        put_triangles(added, picture.triangles);
        put_points(added, relative_to(Vec3::Zero(), picture.nodes));
    }
    Object& object = objects_[known->second];
    put_pose(object, collider.pose.position, rotation_matrix(collider.pose.rotation));
    ++object.frames;
}

void UsdFilm::add(const Frame& frame) {
    // Frame times are multiples of frame_step, apart from rounding errors, which are removed here. Only the last frame
    // of a stopped run may have another time.
    constexpr Real slack = 1e-6;
    const Real steps = frame.time / settings_.frame_step, nearest = std::round(steps);
    const Real time = std::abs(steps - nearest) < slack ? nearest : steps;
    if (!patch_) patch_ = patch_around(frame.bodies);
    std::vector<std::vector<Real>> quantity(frame.bodies.size());
    if (settings_.color != FilmColor::none) quantity = quantity_of_nodes(frame, settings_.color);
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) put_body(frame.bodies[b], quantity[b]);
    for (const ColliderFrame& collider : frame.colliders) put_collider(collider);
    times_.push_back(time);
}

CrateSpec UsdFilm::prim(const char* type, std::string name) {
    return {.name = std::move(name), .fields = {{"specifier", file_.defines()}, {"typeName", file_.token(type)}}};
}

CrateSpec UsdFilm::attribute(const char* name, const char* type, CrateValue value) {
    return {.kind = SpecKind::attribute, .name = name, .fields = {{"typeName", file_.token(type)}, {"default", value}}};
}

CrateSpec UsdFilm::uniform(const char* name, const char* type, CrateValue value) {
    CrateSpec spec = attribute(name, type, value);
    spec.fields.emplace_back("variability", file_.uniform());
    return spec;
}

CrateSpec UsdFilm::primvar(CrateSpec spec, const char* interpolation) {
    spec.fields.emplace_back("interpolation", file_.token(interpolation));
    return spec;
}

/// Returns an attribute with time samples, or with a single value if all values are equal.
CrateSpec UsdFilm::animated(const Object& object, const char* name, const char* type,
                            std::span<const CrateValue> values) {
    CrateSpec spec = attribute(name, type, values.front());
    if (std::ranges::all_of(values, [&](CrateValue value) { return value == values.front(); })) return spec;
    const auto [known, is_new] = written_times_.try_emplace({object.first, values.size()});
    if (is_new) known->second = file_.times(std::span(times_).subspan(object.first, values.size()));
    spec.fields.back() = {"timeSamples", file_.time_samples(known->second, values)};
    return spec;
}

/// Adds the colours to `mesh`, and the values of the quantity that they show, if any.
void UsdFilm::put_colors(const Object& object, std::size_t number, CrateSpec& mesh) {
    constexpr const char *name = "primvars:displayColor", *type = "color3f[]";
    const auto written = [&](const std::vector<Color>& colors) {
        return file_.array(CrateType::vec3_float, std::span<const Color>(colors));
    };
    if (object.quantity.values.empty()) {
        const Color color = object.surface ? color_of_body(number) : color_of_colliders();
        mesh.children.push_back(primvar(attribute(name, type, written({color})), "constant"));
        return;
    }
    std::vector<CrateValue> values;
    for (std::size_t frame = 0; frame < object.frames; ++frame) {
        const CrateValue quantity = object.quantity.values[frame];
        if (frame > 0 && quantity == object.quantity.values[frame - 1]) {
            values.push_back(values.back());
            continue;
        }
        std::vector<Color> colors;
        for (const float value : file_.read_array<float>(quantity)) colors.push_back(color_of_value(value, top_));
        values.push_back(written(colors));
    }
    const std::string quantity = std::string("primvars:") + quantity_of(settings_.color).name;
    mesh.children.push_back(primvar(animated(object, name, type, values), "vertex"));
    mesh.children.push_back(primvar(animated(object, quantity.c_str(), "float[]", object.quantity.values), "vertex"));
}

/// Adds the texture coordinates of a visual surface, and its materials with the triangles that have them.
void UsdFilm::put_materials(Object& object, const VisualSurface& surface) {
    if (!surface.texture_corners.empty()) {
        std::vector<Vec2f> points;
        std::vector<std::int32_t> corners;
        for (const auto& [u, v] : surface.texture_points)
            points.push_back({static_cast<float>(u), static_cast<float>(v)});
        for (const auto& triangle : surface.texture_corners)
            for (const Index corner : triangle) corners.push_back(std::max<Index>(corner, 0));
        object.mesh.push_back(primvar(attribute("primvars:st", "texCoord2f[]",
                                                file_.array(CrateType::vec2_float, std::span<const Vec2f>(points))),
                                      "faceVarying"));
        object.mesh.push_back(attribute("primvars:st:indices", "int[]",
                                        file_.array(CrateType::int32, std::span<const std::int32_t>(corners))));
    }
    for (std::size_t m = 0; m < surface.materials.size(); ++m) {
        std::vector<std::int32_t> faces;
        for (std::size_t face = 0; face < surface.material.size(); ++face)
            if (surface.material[face] == static_cast<Index>(m)) faces.push_back(static_cast<std::int32_t>(face));
        if (faces.empty()) continue;
        CrateSpec subset = prim("GeomSubset", "material_" + std::to_string(m));
        subset.children = {
            uniform("elementType", "token", file_.token("face")),
            uniform("familyName", "token", file_.token("materialBind")),
            attribute("indices", "int[]", file_.array(CrateType::int32, std::span<const std::int32_t>(faces)))};
        bind(subset, material_path(surface.materials[m]));
        object.mesh.push_back(std::move(subset));
    }
}

/// Hides an object in the frames before it was added and after it was removed. Blender ignores animated visibility, so
/// the object is also scaled to the size zero in these frames.
void UsdFilm::put_presence(const Object& object, CrateSpec& mesh) {
    constexpr double before = 1e-3;  // time between old and new size, as USD interpolates sizes [frame steps]
    std::vector<double> times;
    std::vector<bool> present;
    const auto switch_at = [&](double time, bool shown_before, bool shown_after) {
        times.insert(times.end(), {time - before, time});
        present.insert(present.end(), {shown_before, shown_after});
    };
    const std::size_t end = object.first + object.frames;
    if (object.first > 0) switch_at(times_[object.first], false, true);
    if (end < times_.size()) switch_at(times_[end], true, false);
    std::vector<std::string> operations{"xformOp:translate", "xformOp:orient"};
    if (!times.empty()) {
        std::vector<CrateValue> visibility, scale;
        for (const bool shown : present) {
            visibility.push_back(file_.token(shown ? "inherited" : "invisible"));
            const float size = shown ? 1 : 0;
            scale.push_back(file_.scalar(CrateType::vec3_float, Vec3f{size, size, size}));
        }
        const CrateValue written = file_.times(times);
        const auto put = [&](const char* name, const char* type, std::span<const CrateValue> values) {
            mesh.children.push_back(attribute(name, type, values.back()));
            mesh.children.back().fields.back() = {"timeSamples", file_.time_samples(written, values)};
        };
        put("visibility", "token", visibility);
        put("xformOp:scale", "float3", scale);
        operations.emplace_back("xformOp:scale");
    }
    mesh.children.push_back(uniform("xformOpOrder", "token[]", file_.token_array(operations)));
}

CrateSpec UsdFilm::mesh_prim(Object& object, std::size_t number) {
    CrateSpec mesh = prim("Mesh", object.name);
    mesh.children = std::move(object.mesh);
    const auto put = [&](const char* name, const char* type, const Track& track) {
        if (!track.values.empty()) mesh.children.push_back(animated(object, name, type, track.values));
    };
    put("points", "point3f[]", object.points);
    put("velocities", "vector3f[]", object.velocities);
    put("extent", "float3[]", object.extent);
    put("xformOp:translate", "double3", object.translate);
    put("xformOp:orient", "quatf", object.orient);
    put_presence(object, mesh);
    put_colors(object, number, mesh);
    mesh.children.push_back(uniform("subdivisionScheme", "token", file_.token("none")));
    bind(mesh, vertex_color_path);
    return mesh;
}

/// Gives a prim the material at `path`.
void UsdFilm::bind(CrateSpec& spec, const std::string& path) {
    spec.fields.emplace_back("apiSchemas", file_.prepended_token("MaterialBindingAPI"));
    spec.children.push_back({.kind = SpecKind::relationship,
                             .name = "material:binding",
                             .fields = {{"targetPaths", file_.target(path)}, {"variability", file_.uniform()}},
                             .children = {}});
}

CrateSpec UsdFilm::unset(const char* name, const char* type) {
    return {.kind = SpecKind::attribute, .name = name, .fields = {{"typeName", file_.token(type)}}};
}

CrateSpec UsdFilm::connected(const char* name, const char* type, const std::string& source) {
    CrateSpec spec = unset(name, type);
    spec.fields.emplace_back("connectionPaths", file_.target(source));
    return spec;
}

CrateSpec UsdFilm::shader(std::string name, const char* kind) {
    CrateSpec spec = prim("Shader", std::move(name));
    spec.children.push_back(uniform("info:id", "token", file_.token(kind)));
    return spec;
}

/// Adds a material to `looks_`. `diffuse`: colour of the material, a value or a connection to a shader. `inputs`: the
/// shaders that `diffuse` needs.
void UsdFilm::add_material(const std::string& path, CrateSpec diffuse, Real opacity, std::vector<CrateSpec> inputs) {
    CrateSpec surface = shader("surface", "UsdPreviewSurface");
    surface.children.push_back(std::move(diffuse));
    surface.children.push_back(attribute("inputs:roughness", "float", file_.float32(0.5F)));
    surface.children.push_back(attribute("inputs:opacity", "float", file_.float32(static_cast<float>(opacity))));
    surface.children.push_back(unset("outputs:surface", "token"));
    CrateSpec material = prim("Material", path.substr(path.rfind('/') + 1));
    material.children = std::move(inputs);
    material.children.push_back(connected("outputs:surface", "token", path + "/surface.outputs:surface"));
    material.children.push_back(std::move(surface));
    looks_.push_back(std::move(material));
}

/// Adds the material that shows the colours of the vertices.
void UsdFilm::add_vertex_color() {
    const std::string path = vertex_color_path;
    CrateSpec reader = shader("color", "UsdPrimvarReader_float3");
    reader.children.push_back(attribute("inputs:varname", "string", file_.string("displayColor")));
    reader.children.push_back(unset("outputs:result", "float3"));
    add_material(path, connected("inputs:diffuseColor", "color3f", path + "/color.outputs:result"), 1, {reader});
}

/// Returns the path of a material. Adds the material if no body used it before.
std::string UsdFilm::material_path(const VisualMaterial& material) {
    const auto known = std::ranges::find(materials_, material, &std::pair<VisualMaterial, std::string>::first);
    if (known != materials_.end()) return known->second;
    const std::string path = looks_path + unique_name(material.name, "material");
    materials_.emplace_back(material, path);
    if (material.texture.empty()) {
        const Color color = color_of_material(material);
        add_material(path, attribute("inputs:diffuseColor", "color3f", file_.scalar(CrateType::vec3_float, color)),
                     material.opacity, {});
        return path;
    }
    CrateSpec reader = shader("st", "UsdPrimvarReader_float2");
    reader.children.push_back(attribute("inputs:varname", "string", file_.string("st")));
    reader.children.push_back(unset("outputs:result", "float2"));
    CrateSpec texture = shader("texture", "UsdUVTexture");
    const std::filesystem::path texture_path = std::filesystem::proximate(material.texture, folder_);
    texture.children.push_back(attribute("inputs:file", "asset", file_.asset_path(texture_path.generic_string())));
    texture.children.push_back(attribute("inputs:wrapS", "token", file_.token("repeat")));
    texture.children.push_back(attribute("inputs:wrapT", "token", file_.token("repeat")));
    texture.children.push_back(connected("inputs:st", "float2", path + "/st.outputs:result"));
    texture.children.push_back(unset("outputs:rgb", "float3"));
    add_material(path, connected("inputs:diffuseColor", "color3f", path + "/texture.outputs:rgb"), material.opacity,
                 {reader, texture});
    return path;
}

Real UsdFilm::close() {
    top_ = settings_.color_max.value_or(usual_top(quantity_));
    CrateSpec looks = prim("Scope", "Looks"), world = prim("Xform", "World");
    add_vertex_color();
    looks.children = std::move(looks_);
    if (settings_.color != FilmColor::none) {
        const double range[] = {0, top_};
        world.children.push_back(
            attribute("userProperties:color_range", "double2", file_.scalar(CrateType::vec2_double, range)));
        world.children.back().fields.emplace_back("custom", file_.boolean(true));
    }
    world.children.push_back(std::move(looks));
    for (std::size_t number = 0; number < objects_.size(); ++number)
        world.children.push_back(mesh_prim(objects_[number], number));
    CrateSpec root{.kind = SpecKind::root, .name = ""};
    const double rate = 1 / settings_.frame_step;
    root.fields = {{"defaultPrim", file_.token(world.name)},
                   {"upAxis", file_.token("Z")},
                   {"metersPerUnit", file_.float64(1)},
                   {"timeCodesPerSecond", file_.float64(rate)},
                   {"framesPerSecond", file_.float64(rate)}};
    if (!times_.empty()) {
        root.fields.emplace_back("startTimeCode", file_.float64(times_.front()));
        root.fields.emplace_back("endTimeCode", file_.float64(times_.back()));
    }
    root.children.push_back(std::move(world));
    file_.close(std::move(root));
    return top_;
}

}  // namespace skerry
