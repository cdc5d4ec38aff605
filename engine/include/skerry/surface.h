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

/// Surface properties of contacts between two materials. A property that is not given follows the general rule: the
/// geometric mean of both friction coefficients, and the larger restitution.
struct MaterialPair {
    MaterialHandle first{}, second{};  // may be the same
    SurfaceSettings surface{};         // properties of the pair
};

/// A view of the pairs of materials of a world. It is valid until the world is moved or destroyed. Functions that
/// change pairs may only be called between calls of advance. They throw SceneError and change nothing if a handle is
/// stale or a value is out of range. Pairs belong to the state of the world: they are saved, cloned and hashed. The
/// order of the two materials of a pair has no effect.
class SurfacePairs {
public:
    /// `world` must exist as long as the view.
    explicit SurfacePairs(World& world) : world_(&world) {}

    /// Sets the properties of contacts between two materials, and wakes the bodies that have one of them. A body has
    /// one material for this purpose, BodySettings::material. Contacts of the pair ignore friction and restitution of
    /// single bodies and colliders, but not those of surface sets.
    void set(MaterialHandle first, MaterialHandle second, const SurfaceSettings& surface);
    /// Removes the properties of a pair. Without such properties, does nothing.
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
/// edges and nodes, and of the given nodes with the edges and faces between them.
struct SurfaceSetSettings {
    BodyHandle body{};                          // a body with faces: not a sphere, capsule or cylinder
    std::vector<Index> nodes{};                 // numbers in the mesh; nodes inside the body have no effect
    std::vector<std::array<Index, 3>> faces{};  // boundary faces by their nodes, in any order
    SurfaceSettings surface{};                  // missing properties are those of the body
    // Friction coefficient of sliding contacts across `direction`, > 0; static friction changes in the same ratio. The
    // friction in `surface`, which must be given, then applies along `direction`.
    std::optional<Real> friction_across{};
    // Direction in the frame of the mesh, carried along by the faces when the body moves and deforms. Required for
    // friction_across.
    std::optional<Vec3> direction{};
};

extern template class __attribute__((visibility("default"))) ObjectView<SurfaceSetHandle>;

/// A view of the surface sets of a world.
class SurfaceSets : public ObjectView<SurfaceSetHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a set. It is removed with its body. Where sets overlap, the set that was added last applies. A property of
    /// a set takes precedence over that of the pair of materials; it is combined with the property of the other surface
    /// like the property of a body. For two surfaces with directions, the geometric mean of both friction tensors
    /// applies.
    SurfaceSetHandle add(const SurfaceSetSettings& set);
    /// Settings of a set.
    SurfaceSetSettings settings(SurfaceSetHandle set) const;
    /// Changes the properties of a set, and wakes its body. `friction_across` needs a set with a direction.
    void set_surface(SurfaceSetHandle set, const SurfaceSettings& surface, std::optional<Real> friction_across = {});
};

}  // namespace skerry
#pragma GCC visibility pop
