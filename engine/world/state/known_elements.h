// What the explicit elements of one mesh and material have in common, as far as it takes longer to find than to copy.
#pragma once

#include "components/column.h"
#include "components/element_table.h"
#include "components/options.h"
#include "components/types.h"
#include "systems/dynamics/elements/build_elements.h"

namespace skerry {

/// In which order the elements of a body stand, how they share masses and relax, and the step that they stand, as the
/// mesh lies: a function of mesh, materials and `element` alone. Kept from when the body comes
/// until the world is settled or rows of bodies move.
struct KnownElements {
    Index body;           // that has the mesh and the materials
    ElementKind element;  // as it was asked for

    ElementPlaces places;
    Column<ElementLane> mass_share, relaxation_rate, own_frequency;
    Column<ElementForm> mass_form;
    Column<FrameMass> frame_mass;
    Column<Real> frame_bound, relaxing_share;
    Real rest_step;  // s

    /// Of each: what is known, and the column of the model.
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
