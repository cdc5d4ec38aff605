// Builds a film as a USD scene, frame by frame.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/output/film/crate_file.h"
#include "engine/output/film/drawn_surface.h"
#include "engine/output/shape_picture.h"

namespace skerry {

/// Writes one prim of type Mesh for each body and each collider. Vertices are relative to the transform of the prim, so
/// that rounding errors of floats do not grow with the distance from the origin of the world.
///
/// The transform of a rigid body moves with the body, so its vertices are written again only if its shape changes. An
/// unchanged value takes only 8 bytes per frame.
class UsdFilm {
public:
    /// `file` must be empty, and must support writing, reading and seeking. It must outlive the object.
    /// `folder`: folder of the film, to which paths of textures are relative.
    UsdFilm(std::iostream& file, std::filesystem::path folder, const FilmSettings& settings);
    /// The time of the frame must be later than that of the previous frame.
    void add(const Frame& frame);
    /// Completes the file. Returns the value at the upper end of the colours.
    Real close();

private:
    /// Values of an attribute in consecutive frames.
    struct Track {
        std::vector<CrateValue> values;
        std::string bytes;  // bytes of the last value, to find out whether the next one differs
    };
    struct Object {
        std::string name;                   // valid and unique name of the prim
        std::size_t first = 0, frames = 0;  // first frame that shows the object, and number of such frames
        std::vector<CrateSpec> mesh;        // attributes that never change
        std::optional<DrawnSurface> surface;
        // For a rigid body: origin of the prim in body coordinates, and the vertices relative to this origin [m].
        Vec3 center = Vec3::Zero();
        std::vector<Vec3> rigid_points;
        Track translate, orient, points, velocities, extent, quantity;
    };

    std::string unique_name(std::string_view name, std::string_view name_if_empty);
    Object& add_object(std::string_view name, std::string_view name_if_empty);
    void put_triangles(Object& object, std::span<const std::array<Index, 3>> triangles);
    template <class T>
    void put(Track& track, std::span<const T> content, CrateType type, bool is_array);
    void put_pose(Object& object, const Vec3& position, const Mat3& rotation);
    void put_points(Object& object, std::span<const Vec3f> points);
    void put_rigid_body(Object& object, const MotionKey& pose, std::span<const Vec3> points);
    void put_body(const BodyFrame& body, std::span<const Real> quantity);
    void put_collider(const ColliderFrame& collider);

    CrateSpec prim(const char* type, std::string name);
    CrateSpec attribute(const char* name, const char* type, CrateValue value);
    CrateSpec uniform(const char* name, const char* type, CrateValue value);
    CrateSpec primvar(CrateSpec attribute, const char* interpolation);
    CrateSpec animated(const Object& object, const char* name, const char* type, std::span<const CrateValue> values);
    void put_colors(const Object& object, std::size_t number, CrateSpec& mesh);
    void put_presence(const Object& object, CrateSpec& mesh);
    CrateSpec mesh_prim(Object& object, std::size_t number);
    void put_materials(Object& object, const VisualSurface& surface);
    void bind(CrateSpec& spec, const std::string& path);
    CrateSpec unset(const char* name, const char* type);
    CrateSpec connected(const char* name, const char* type, const std::string& source);
    CrateSpec shader(std::string name, const char* kind);
    void add_material(const std::string& path, CrateSpec diffuse, Real opacity, std::vector<CrateSpec> inputs);
    void add_vertex_color();
    std::string material_path(const VisualMaterial& material);

    CrateFile file_;
    std::filesystem::path folder_;
    FilmSettings settings_;
    std::vector<double> times_;  // time of each frame added so far [frame steps]
    std::vector<Object> objects_;
    std::set<std::string, std::less<>> names_;
    std::map<BodyHandle, std::size_t> body_object_;
    std::map<ColliderHandle, std::size_t> collider_object_;
    std::vector<CrateSpec> looks_;                                   // materials
    std::vector<std::pair<VisualMaterial, std::string>> materials_;  // materials of visual surfaces, and their paths
    std::optional<PlanePatch> patch_;  // part of infinite planes to display, in world coordinates
    Quantile quantity_;
    Real top_ = 0;
    // Lists of times already written to the file, by first frame and number of frames. Objects with equal lists share
    // one.
    std::map<std::pair<std::size_t, std::size_t>, CrateValue> written_times_;
};

}  // namespace skerry
