// Fibres in bodies, which resist stretch and contract like muscle (docs/methods/elasticity.md 2.7).
#pragma once

#include <vector>

#include "components/handle.h"
#include "components/types.h"
#include "skerry/object_view.h"
#include "skerry/time_table.h"

#pragma GCC visibility push(default)
namespace skerry {

class World;

/// A family of fibres in tetrahedra of a body. Fibres resist stretch, but not compression. With their squared stretch
/// I_4 and E = max(I_4 - 1, 0), they add to the material this energy per rest volume (Holzapfel, Gasser, Ogden 2000):
///     W = k_1/(2 k_2) (exp(k_2 E^2) - 1), or k_1 E^2 / 2 if k_2 = 0
struct FibreSettings {
    BodyHandle body{};  // explicit body, or implicit body if Settings::theta is 1
    // Numbers of tetrahedra in the mesh of the body, each at most once; empty: all tetrahedra
    std::vector<Index> tetrahedra{};
    // Directions in the frame of the mesh, of any length except zero: one for all of `tetrahedra`, or one for each.
    std::vector<Vec3> direction{Vec3::UnitX()};
    // Constant k_1 of the energy, >= 0 [Pa]. Fibres that are stretched a little have Young's modulus 4 k_1.
    Real stiffness = 0;
    Real exponent = 0;      // constant k_2 of the energy, >= 0 [1]
    TimeTable tension = 0;  // active tension >= 0: force along the fibres per area of the rest shape [Pa]
};

/// Present state of a family of fibres.
struct FibreState {
    BodyHandle body{};  // body of the fibres
    Real tension = 0;   // present active tension [Pa]
    Real energy = 0;    // energy of the stretch [J]
    // The following lists have one entry for each tetrahedron with fibres. `tetrahedra`: its number in the mesh.
    std::vector<Index> tetrahedra{};
    std::vector<Real> stretch{};  // present length of fibres over their length at rest
    std::vector<Real> stress{};   // nominal stress along the fibres, including the active tension [Pa]
};

extern template class __attribute__((visibility("default"))) ObjectView<FibreHandle>;

/// A view of the fibres of a world. Each change wakes the body, unless the new value equals the old one.
class Fibres : public ObjectView<FibreHandle> {
public:
    using ObjectView::ObjectView;

    /// Adds fibres. Stiff fibres shorten the step of the world.
    FibreHandle add(const FibreSettings& fibres);
    /// The body of the fibres.
    BodyHandle body(FibreHandle fibres) const;
    /// Stretch, tension and energy of the fibres after the last step.
    FibreState state(FibreHandle fibres) const;
    /// Settings of the fibres. `tetrahedra` and `direction` list every tetrahedron with fibres, even if add() got
    /// shorter lists.
    FibreSettings settings(FibreHandle fibres) const;
    /// Sets the active tension [Pa].
    void set_tension(FibreHandle fibres, const TimeTable& tension);
};

}  // namespace skerry
#pragma GCC visibility pop
