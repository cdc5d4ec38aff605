#include "engine/output/film/usd_film.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "systems/geometry/rotation.h"

namespace skerry {

namespace {

constexpr const char* material = "/World/Looks/vertex_color";

/// Characters that a name of USD may have: letters, digits and underscores, but no digit at the beginning.
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

UsdFilm::UsdFilm(std::iostream& file, const FilmSettings& settings) : file_(file), settings_(settings) {
    names_.insert("Looks");  // prim of the material
}

UsdFilm::Object& UsdFilm::add_object(std::string_view name, std::string_view name_if_empty) {
    const std::string base = identifier(name.empty() ? name_if_empty : name);
    std::string unique = base;
    for (int number = 1; !names_.insert(unique).second; ++number) unique = base + "_" + std::to_string(number);
    Object& object = objects_.emplace_back();
    object.name = unique;
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

/// Appends a value to a track. `content`: the elements of an array, or the only element of a single value.
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

/// Puts the vertices relative to the frame of a rigid body. They are put again only if the body has become another
/// shape, not if they differ by rounding errors.
void UsdFilm::put_rigid_body(Object& object, const MotionKey& pose, std::span<const Vec3> points) {
    constexpr Real tolerance = 1e-7;  // relative to the radius of the body, as the rounding error of a float
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
    auto known = body_object_.find(body.handle);
    if (known == body_object_.end()) {
        Object& added = add_object(body.name, "body");
        added.surface.emplace(body);
        put_triangles(added, added.surface->triangles());
        known = body_object_.emplace(body.handle, objects_.size() - 1).first;
    }
    Object& object = objects_[known->second];
    const DrawnSurface& surface = *object.surface;
    const std::vector<Vec3> points = surface.at_vertices(body.position);
    if (body.rigid_pose) {
        put_rigid_body(object, *body.rigid_pose, points);
    } else {
        const std::vector<Vec3> velocities = surface.at_vertices(body.velocity);
        const Vec3 origin = mean_of(points);
        object.rigid_points.clear();
        put_pose(object, origin, Mat3::Identity());
        put_points(object, relative_to(origin, points));
        // The transform moves with the mean velocity.
        const std::vector<Vec3f> relative = relative_to(mean_of(velocities), velocities);
        put(object.velocities, std::span<const Vec3f>(relative), CrateType::vec3_float, true);
    }
    if (!quantity.empty()) {
        std::vector<float> values;
        for (const Real value : surface.at_vertices(quantity)) {
            values.push_back(static_cast<float>(value));
            quantity_.add(value);
        }
        put(object.quantity, std::span<const float>(values), CrateType::float32, true);
    }
    ++object.frames;
}

void UsdFilm::put_collider(const ColliderFrame& collider) {
    auto known = collider_object_.find(collider.handle);
    if (known == collider_object_.end()) {
        PlanePatch patch = patch_.value_or(PlanePatch{});
        patch.center = to_shape(collider.pose, patch.center);
        const SurfaceMesh picture = shape_picture(*collider.shape, patch);
        Object& added = add_object(collider.name, "collider");
        put_triangles(added, picture.triangles);
        put_points(added, relative_to(Vec3::Zero(), picture.nodes));
        known = collider_object_.emplace(collider.handle, objects_.size() - 1).first;
    }
    Object& object = objects_[known->second];
    put_pose(object, collider.pose.position, rotation_matrix(collider.pose.rotation));
    ++object.frames;
}

void UsdFilm::add(const Frame& frame) {
    // The time of a frame is a whole number of frame steps, up to rounding, unless the run was stopped.
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
    return {.kind = SpecKind::attribute,
            .name = name,
            .fields = {{"typeName", file_.token(type)}, {"default", value}}};
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

/// Returns an attribute with time samples, or with one value if it is the same in all frames of the object.
CrateSpec UsdFilm::animated(const Object& object, const char* name, const char* type,
                            std::span<const CrateValue> values) {
    CrateSpec spec = attribute(name, type, values.front());
    if (std::ranges::all_of(values, [&](CrateValue value) { return value == values.front(); })) return spec;
    const auto [known, is_new] = written_times_.try_emplace({object.first, values.size()});
    if (is_new) known->second = file_.times(std::span(times_).subspan(object.first, values.size()));
    spec.fields.back() = {"timeSamples", file_.time_samples(known->second, values)};
    return spec;
}

/// Adds the colours, and the quantity that they show.
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
    mesh.children.push_back(
        primvar(animated(object, quantity.c_str(), "float[]", object.quantity.values), "vertex"));
}

/// Hides an object in the frames before it was added and after it was removed. Blender ignores animated visibility, so
/// the object also gets the size zero.
void UsdFilm::put_presence(const Object& object, CrateSpec& mesh) {
    constexpr double before = 1e-3;  // sizes are interpolated, so they change within this fraction of a frame step
    std::vector<double> times;
    std::vector<bool> present;
    const auto change = [&](double time, bool from, bool to) {
        times.insert(times.end(), {time - before, time});
        present.insert(present.end(), {from, to});
    };
    const std::size_t end = object.first + object.frames;
    if (object.first > 0) change(times_[object.first], false, true);
    if (end < times_.size()) change(times_[end], true, false);
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
    mesh.fields.emplace_back("apiSchemas", file_.prepended_token("MaterialBindingAPI"));
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
    mesh.children.push_back({.kind = SpecKind::relationship,
                             .name = "material:binding",
                             .fields = {{"targetPaths", file_.target(material)}, {"variability", file_.uniform()}}});
    return mesh;
}

/// Material that shows the colours of the vertices.
CrateSpec UsdFilm::material_prim() {
    const auto output = [&](const char* name, const char* type) {
        return CrateSpec{
            .kind = SpecKind::attribute, .name = name, .fields = {{"typeName", file_.token(type)}}};
    };
    const auto connected = [&](const char* name, const char* type, const std::string& to) {
        CrateSpec spec = output(name, type);
        spec.fields.emplace_back("connectionPaths", file_.target(to));
        return spec;
    };
    const std::string path = material;
    CrateSpec reader = prim("Shader", "color");
    reader.children = {uniform("info:id", "token", file_.token("UsdPrimvarReader_float3")),
                       attribute("inputs:varname", "string", file_.string("displayColor")),
                       output("outputs:result", "float3")};
    CrateSpec surface = prim("Shader", "surface");
    surface.children = {uniform("info:id", "token", file_.token("UsdPreviewSurface")),
                        connected("inputs:diffuseColor", "color3f", path + "/color.outputs:result"),
                        attribute("inputs:roughness", "float", file_.float32(0.5F)),
                        output("outputs:surface", "token")};
    CrateSpec shown = prim("Material", path.substr(path.rfind('/') + 1));
    shown.children = {connected("outputs:surface", "token", path + "/surface.outputs:surface"), std::move(surface),
                      std::move(reader)};
    return shown;
}

Real UsdFilm::close() {
    top_ = settings_.color_max.value_or(usual_top(quantity_));
    CrateSpec looks = prim("Scope", "Looks"), world = prim("Xform", "World");
    looks.children.push_back(material_prim());
    if (settings_.color != FilmColor::none) {
        const double range[] = {0, top_};
        world.children.push_back(attribute("userProperties:color_range", "double2",
                                           file_.scalar(CrateType::vec2_double, range)));
        world.children.back().fields.emplace_back("custom", file_.boolean(true));
    }
    world.children.push_back(std::move(looks));
    for (std::size_t number = 0; number < objects_.size(); ++number)
        world.children.push_back(mesh_prim(objects_[number], number));
    CrateSpec root{.kind = SpecKind::root, .name = "", .fields = {}, .children = {}};
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
