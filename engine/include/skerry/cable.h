// Cables that run through points of bodies (docs/methods/cables.md).
#pragma once

#include <optional>
#include <vector>

#include "components/cable_control.h"
#include "components/types.h"
#include "skerry/anchor.h"
#include "skerry/object_view.h"
#include "skerry/time_table.h"

#pragma GCC visibility push(default)
namespace skerry {

/// The quantity of a cable that is prescribed. Exactly one member must be given. A cable pulls, but never pushes.
struct CableDrive {
    std::optional<TimeTable> tension{};  // tension of the first segment, >= 0 [N]
    std::optional<TimeTable> length{};   // greatest length of the cable, > 0 [m]; a shorter cable is slack
    // Rate of change of the cable's greatest length, which starts at the present length [m/s]. A negative rate draws
    // the cable in.
    std::optional<TimeTable> rate{};
};

/// A cable without mass and without elasticity. It runs straight from point to point, and is drawn in or let out at the
/// first point.
struct CableSettings {
    std::vector<Anchor> points;  // points of the cable, at least two; neighbours must not coincide
    CableDrive drive;            // prescribed tension, greatest length or rate
    // Friction coefficient mu at the points between the first and the last, >= 0. Where the cable bends by the angle
    // theta, it slides over the point if the ratio of the tensions on both sides reaches exp(mu theta) (Euler and
    // Eytelwein).
    Real friction = 0;
};

/// Present state of a cable.
struct CableState {
    std::vector<Anchor> points;  // the points of the settings, at their present positions [m]
    std::vector<Real> tension;   // tension of each segment in the last step [N]
    Real length = 0;             // present length [m]
    Real rate = 0;               // present rate of the length [m/s]
    // greatest length of the cable at present [m]; empty if its tension is prescribed
    std::optional<Real> released{};
    Real work = 0;        // work of the drive on the cable since the cable was added [J]
    Real dissipated = 0;  // energy dissipated by friction at the points since the cable was added [J]
};

extern template class __attribute__((visibility("default"))) ObjectView<CableHandle>;

/// A view of the cables of a world.
class Cables : public ObjectView<CableHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds a cable. If the cable has friction, or a prescribed length or rate, all its bodies are solved in one
    /// contact region, together with their contacts.
    CableHandle add(const CableSettings& cable);
    /// Points, tensions, length and work of a cable after the last step.
    CableState state(CableHandle cable) const;
    /// Settings with which add() would make a cable like this one in its present state: the points have their present
    /// positions.
    CableSettings settings(CableHandle cable) const;
    /// Replaces the drive. A drive equal to the present one changes no bit of the state. If the new drive is a rate,
    /// the greatest length starts at the present length of the cable, or, if the old drive is a rate, too, at its
    /// present value.
    void set_drive(CableHandle cable, const CableDrive& drive);
};

}  // namespace skerry
#pragma GCC visibility pop
