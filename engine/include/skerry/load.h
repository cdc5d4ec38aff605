// Loads on nodes and faces, and force fields, with values that change over time (docs/methods/loads.md).
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "components/handle.h"
#include "components/load_kind.h"
#include "components/types.h"
#include "skerry/object_view.h"
#include "skerry/time_table.h"

#pragma GCC visibility push(default)
namespace skerry {

/// A force on some nodes of a body, for example on the tip of a beam. The nodes share the force in proportion to the
/// masses that they have when the load is added.
struct ForceLoad {
    BodyHandle body{};           // body of the nodes
    std::vector<Index> nodes{};  // numbers in the mesh of the body, at least one, each at most once
    Vec3 force = Vec3::Zero();   // total force on all nodes, in world axes [N]
    TimeTable scale = 1;         // factor over time
};

/// A traction on some surface faces of a body. Its direction is fixed in the world. The force on a face is divided
/// equally among the three nodes of the face.
struct TractionLoad {
    BodyHandle body{};  // body of the faces
    // Faces as World::surface(body) lists them: numbers of nodes in any order; at least one face, each at most once.
    std::vector<std::array<Index, 3>> faces{};
    Vec3 traction = Vec3::Zero();         // force per area, in world axes [Pa]
    TimeTable scale = 1;                  // factor over time
    LoadArea area = LoadArea::reference;  // the area of the faces in the rest shape (dead load), or the present area
};

/// A uniform acceleration of bodies, added to the gravity of the settings, for example the apparent acceleration in a
/// shaken frame of reference.
struct AccelerationField {
    std::optional<BodyHandle> body{};  // if it is not given, the field acts on all bodies
    Vec3 acceleration = Vec3::Zero();  // [m/s^2]
    TimeTable scale = 1;               // factor over time
};

/// A factor of the weight, which is the gravity of the settings times the mass. A factor of one body replaces that of
/// all bodies. The potential energy in reports is that of the whole weight. The difference between scaled and whole
/// weight is treated as a load that does work.
struct GravityScale {
    // if it is not given, the factor applies to all bodies without a factor of their own
    std::optional<BodyHandle> body{};
    TimeTable scale = 1;  // factor over time
};

/// A drag towards the velocity of a wind. The force on a node of mass m and velocity v is m rate (wind - v).
///
/// A body that nothing else moves takes up the velocity of the wind with the time constant 1/rate, whatever its shape.
/// Steps are not longer than 1/rate, so that the drag in one step cannot reverse a velocity.
struct DragField {
    std::optional<BodyHandle> body{};  // if it is not given, the field acts on all bodies
    Real rate = 0;                     // force per mass and relative velocity, > 0 [1/s]
    Vec3 wind = Vec3::Zero();          // velocity of the wind [m/s]
    TimeTable scale = 1;               // factor of `wind` over time
};

/// A load of any kind.
using AnyLoad = std::variant<ForceLoad, TractionLoad, AccelerationField, GravityScale, DragField>;

/// State of a load at the present time.
struct LoadState {
    LoadKind kind = LoadKind::force;   // kind of the load
    std::optional<BodyHandle> body{};  // missing if the load acts on all bodies
    // Value without the scale: force [N], traction [Pa], acceleration [m/s^2] or velocity of the wind [m/s]. Zero for a
    // factor of the weight.
    Vec3 vector = Vec3::Zero();
    Real rate = 0;   // rate of a drag [1/s]
    Real scale = 1;  // value of `scale` at the present time
    // Sum of the present forces on all nodes [N]. For a factor of the weight: the scaled weight minus the full weight.
    Vec3 force = Vec3::Zero();
};

extern template class __attribute__((visibility("default"))) ObjectView<LoadHandle>;

/// A view of the loads of a world. They act on explicit, implicit and rigid bodies, in addition to the forces of
/// World::set_loads.
///
/// Every load is multiplied by its `scale`, which may change over time. A step uses the mean of the scale over the time
/// in which its forces act. The impulses of all steps therefore add up to the integral of the force over time.
class Loads : public ObjectView<LoadHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a load.
    LoadHandle add(const ForceLoad& load);
    LoadHandle add(const TractionLoad& load);
    LoadHandle add(const AccelerationField& field);
    LoadHandle add(const GravityScale& factor);
    LoadHandle add(const DragField& drag);
    /// Kind and present values of a load.
    LoadState state(LoadHandle load) const;
    /// Settings of a load.
    AnyLoad settings(LoadHandle load) const;
    /// Replaces the scale of a load. Setting an equal scale changes no bit of the state.
    void set_scale(LoadHandle load, const TimeTable& scale);
    /// Replaces force, traction, acceleration or velocity of the wind. Throws SceneError for a factor of the weight.
    void set_vector(LoadHandle load, const Vec3& vector);
};

}  // namespace skerry
#pragma GCC visibility pop
