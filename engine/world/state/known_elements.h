// Data shared by the explicit elements of all bodies with one mesh and material: those that are slower to find than to
// copy.
#pragma once

#include "components/column.h"
#include "components/element_table.h"
#include "components/options.h"
#include "components/types.h"
#include "systems/dynamics/elements/build_elements.h"

namespace skerry {

/// Order of the elements of a body, their mass shares and relaxation, and their stable step in the shape of the mesh.
/// All of it is a function of mesh, materials and `element` alone. Kept from the time the body is added until the world
/// is settled or rows of bodies move.
struct KnownElements {
    Index body;           // row of the body that has the mesh and the materials
    ElementKind element;  // the kind that was requested

    ElementPlaces places;
    Column<ElementLane> mass_share, relaxation_rate, own_frequency;
    Column<ElementForm> mass_form;
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound, relaxing_share;
    Real rest_step;  // stable step at rest [s]

    /// Calls `visit` with each known column and its column of the model.
    static void for_each_column(auto& known, auto& elements, auto&& visit) {
        visit(known.mass_share, elements.mass_share);
        visit(known.relaxation_rate, elements.relaxation_rate);
        visit(known.own_frequency, elements.own_frequency);
        visit(known.mass_form, elements.mass_form);
        visit(known.frame_mass, elements.frame_mass);
        visit(known.frame_bound, elements.frame_bound);
        visit(known.relaxing_share, elements.relaxing_share);
    }
};

}  // namespace skerry
