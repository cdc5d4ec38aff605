// Inverse masses at the anchors (ends) of springs, and the bounds by which springs limit the stable step
// (docs/methods/springs.md 2).
#pragma once

#include <span>

#include "engine/world/state/model.h"
#include "systems/forces/springs.h"

namespace skerry {

SpringInputs springs_of(const Model& model);
/// Computes SpringTable::first_mass and second_mass: for the two anchors of each spring, the inverse mass, and how many
/// dampers share this mass.
void weigh_springs(Model& model);
/// See ForceElement::add_rate and ForceElement::bound_damping.
void add_spring_rates(Model& model, std::span<Real> of_body);
void bound_spring_damping(const Model& model, std::span<Real> of_body);

}  // namespace skerry
