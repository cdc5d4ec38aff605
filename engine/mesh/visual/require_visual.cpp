#include <algorithm>

#include "engine/base/complaint.h"
#include "engine/mesh/visual/bound_visual.h"

namespace skerry {

namespace {

void require_entries(const std::string& object, const char* field, std::size_t found, std::size_t triangles) {
    if (found != 0 && found != triangles)
        refuse(object, field, std::to_string(found) + " entries",
               "none, or one for each of " + std::to_string(triangles) + " triangles");
}

void require_index(const std::string& object, const char* field, Index found, std::size_t count, bool may_be_none) {
    if (may_be_none && found == no_index) return;
    if (found < 0 || static_cast<std::size_t>(found) >= count)
        refuse(object, field, std::to_string(found),
               "an index below " + std::to_string(count) + (may_be_none ? ", or -1" : ""));
}

void require_unit(const std::string& object, const char* field, Real found) {
    if (!(found >= 0 && found <= 1)) refuse(object, field, std::to_string(found), "a number from 0 to 1");
}

}  // namespace

void require_visual(const VisualSurface& surface, const std::string& object) {
    if (surface.triangles.empty()) refuse(object, "triangles", "an empty list", "at least one triangle");
    for (const Vec3& node : surface.nodes) require_finite(object, "nodes", node);
    for (const std::array<Real, 2>& point : surface.texture_points)
        require_finite(object, "texture_points", Vec3(point[0], point[1], 0));
    for (const std::array<Index, 3>& triangle : surface.triangles)
        for (const Index n : triangle) require_index(object, "triangles", n, surface.nodes.size(), false);
    require_entries(object, "texture_corners", surface.texture_corners.size(), surface.triangles.size());
    for (const std::array<Index, 3>& corners : surface.texture_corners) {
        for (const Index p : corners) require_index(object, "texture_corners", p, surface.texture_points.size(), true);
        if (const auto none = std::ranges::count(corners, no_index); none != 0 && none != 3)
            refuse(object, "texture_corners", "a triangle of which some corners have a texture point",
                   "texture points at all three corners, or at none");
    }
    require_entries(object, "material", surface.material.size(), surface.triangles.size());
    for (const Index m : surface.material) require_index(object, "material", m, surface.materials.size(), true);
    for (const VisualMaterial& material : surface.materials) {
        for (const Real part : material.color) require_unit(object, "color", part);
        require_unit(object, "opacity", material.opacity);
    }
}

}  // namespace skerry
