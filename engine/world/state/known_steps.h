// What was found of meshes while bodies come, so that bodies of one mesh have it once.
#pragma once

#include <array>
#include <vector>

#include "components/element_table.h"
#include "components/options.h"

namespace skerry {

/// How the explicit elements of a mesh share masses and relax, and the step that they stand, as the mesh lies: a
/// function of what comes first alone. Kept from when a body comes until the world is settled.
struct KnownSteps {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 4>> tetrahedra;
    std::vector<Index> material;  // by tetrahedron
    ElementKind element;          // as it was asked for

    Column<ElementLane> mass_share, relaxation_rate, own_frequency;
    Column<ElementForm> mass_form;
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound, relaxing_share;
    Real rest_step;  // s

    /// Of each: what is known, and the column of the model.
    void for_each_column(ElementBlockTable& elements, auto&& visit) {
        visit(mass_share, elements.mass_share);
        visit(relaxation_rate, elements.relaxation_rate);
        visit(own_frequency, elements.own_frequency);
        visit(mass_form, elements.mass_form);
        visit(frame_mass, elements.frame_mass);
        visit(frame_bound, elements.frame_bound);
        visit(relaxing_share, elements.relaxing_share);
    }
};

}  // namespace skerry
