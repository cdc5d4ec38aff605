// Stored properties of the explicit elements of a body. Later bodies with the same mesh and materials copy them, which
// is faster than computing them again.
#pragma once

#include "components/column.h"
#include "components/element_table.h"
#include "components/options.h"
#include "components/types.h"
#include "systems/dynamics/elements/build_elements.h"

namespace skerry {

/// Order of the elements of a body in its blocks, their shares of the node masses, their relaxation, and the stable
/// step of the mesh. These data depend only on mesh, materials and element kind. WorldState::settle deletes the entry,
/// and so does any function that moves rows of bodies.
struct KnownElements {
    Index body;           // row of a body with this mesh and these materials
    ElementKind element;  // element kind requested by the user

    ElementPlaces places;
    Column<ElementLane> mass_share, own_frequency;
    Column<RelaxationRates> relaxation_rate;
    Column<ElementForm> mass_form;
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound, relaxing_share;
    Real rest_step;  // stable step at rest [s]

    /// Calls visit(stored column, column of the model) for each column that is stored here.
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
