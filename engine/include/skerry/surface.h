// Friction and restitution by pair of materials and by place on a body (docs/methods/friction.md 4).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "components/handle.h"
#include "components/types.h"
#include "skerry/control.h"
#include "skerry/object_view.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// Surface properties of contacts between two materials. A property that `surface` does not give follows the general
/// rule: the geometric mean of the friction coefficients of both objects, and the larger of their restitutions.
struct MaterialPair {
    MaterialHandle first{}, second{};  // both may be the same material
    SurfaceSettings surface{};         // properties of the pair
};

/// A view of the surface properties of pairs of materials in a world. It is valid until the world is moved or
/// destroyed. Pairs belong to the state of the world: they are saved, cloned and hashed. The order of the two materials
/// of a pair has no effect.
///
/// Functions that change pairs may only be called between calls of advance. They throw SceneError and change nothing if
/// a handle is stale or a value is out of range.
class SurfacePairs {
public:
    /// `world` must exist as long as the view.
    explicit SurfacePairs(World& world) : world_(&world) {}

    /// Sets the properties of contacts between two materials, and wakes the bodies that have one of them. The material
    /// of a body in a contact is BodySettings::material, even where its tetrahedra have other materials.
    ///
    /// Precedence, highest first: properties of surface sets, of pairs of materials, of single bodies and colliders.
    void set(MaterialHandle first, MaterialHandle second, const SurfaceSettings& surface);
    /// Removes the properties of a pair. Does nothing if the pair has none.
    void remove(MaterialHandle first, MaterialHandle second);
    /// Properties of a pair, in either order; empty if none were set.
    std::optional<SurfaceSettings> surface(MaterialHandle first, MaterialHandle second) const;
    /// All pairs whose properties were set.
    std::vector<MaterialPair> all() const;

    /// Gives a collider a material, or none. The collider then has the friction and restitution of this material unless
    /// it has its own, and takes part in the pairs of this material.
    void set_material(ColliderHandle collider, std::optional<MaterialHandle> material);
    /// The material of a collider; empty if it has none.
    std::optional<MaterialHandle> material(ColliderHandle collider) const;

private:
    World* world_;
};

/// Refers to a surface set of a body.
using SurfaceSetHandle = Handle<struct SurfaceSetTag>;

/// A part of the surface of a body with its own friction and restitution. It consists of the given faces with their
/// edges and nodes, of the given nodes, and of all edges and faces whose nodes are all given.
struct SurfaceSetSettings {
    BodyHandle body{};                          // a body with faces: not a sphere, capsule or cylinder
    std::vector<Index> nodes{};                 // numbers in the mesh; nodes inside the body have no effect
    std::vector<std::array<Index, 3>> faces{};  // boundary faces, each by its three nodes in any order
    SurfaceSettings surface{};                  // missing properties are those of the body
    // Friction coefficient for sliding perpendicular to `direction`, > 0. It requires that `surface` gives the dynamic
    // friction, > 0, which then applies to sliding along `direction`. The ratio of these two coefficients also applies
    // to static friction.
    std::optional<Real> friction_across{};
    // Direction in the frame of the mesh, of any length but zero. It moves with the faces when the body moves and
    // deforms. Required for friction_across.
    std::optional<Vec3> direction{};
};

extern template class __attribute__((visibility("default"))) ObjectView<SurfaceSetHandle>;

/// A view of the surface sets of a world.
class SurfaceSets : public ObjectView<SurfaceSetHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a set, which is removed with its body. Where sets overlap, the set that was added last applies.
    ///
    /// At a contact, a property of the set replaces that of the body and that of the pair of materials. It is combined
    /// with that of the other object by the general rule (see MaterialPair). If both surfaces have directions, the
    /// contact uses the geometric mean of their friction tensors.
    SurfaceSetHandle add(const SurfaceSetSettings& set);
    /// Settings of a set.
    SurfaceSetSettings settings(SurfaceSetHandle set) const;
    /// Replaces the properties of a set, and wakes its body. Without `friction_across` the friction no longer depends
    /// on the direction. Throws SceneError if `friction_across` is given but the set has no direction.
    void set_surface(SurfaceSetHandle set, const SurfaceSettings& surface, std::optional<Real> friction_across = {});
};

}  // namespace skerry
#pragma GCC visibility pop
