// Kernels: the functions in which set-up and steps spend most of their time. They are compiled once for each
// instruction set of a build (docs/decisions/0018-instruction-sets.md). The engine selects one table of kernels and
// calls the kernels through it.
#pragma once

#include <span>

#include "systems/collision/find_candidates.h"
#include "systems/collision/find_contacts.h"
#include "systems/collision/find_crossings.h"
#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/checks/find_inversions.h"
#include "systems/dynamics/checks/measure_viscosity.h"
#include "systems/dynamics/clusters/kick_clusters.h"
#include "systems/dynamics/elements/compute_element_forces.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/elements/recover_fields.h"
#include "systems/dynamics/elements/yield_elements.h"
#include "systems/dynamics/motion/advance_positions.h"
#include "systems/dynamics/motion/damp_velocity.h"
#include "systems/dynamics/motion/measure_displacement.h"
#include "systems/dynamics/motion/predict_velocity.h"
#include "systems/dynamics/stability/find_relaxation.h"
#include "systems/dynamics/stability/frame_masses.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/strained_step.h"
#include "systems/dynamics/stability/watch_stable_steps.h"
#include "systems/solver/solve_regions.h"

namespace skerry {

/// Table of the kernels for one instruction set. Each function is documented in the header that declares it. Results
/// are bitwise equal for all instruction sets.
struct Kernels {
    const char* instruction_set;  // name of the instruction set for the compiler, for example x86-64-v3
    decltype(&skerry::find_candidates) find_candidates;
    decltype(&skerry::find_contacts) find_contacts;
    decltype(&skerry::find_crossings) find_crossings;
    decltype(&skerry::check_state) check_state;
    decltype(&skerry::strain_rate) strain_rate;
    decltype(&skerry::find_inversions) find_inversions;
    decltype(&skerry::measure_viscosity) measure_viscosity;
    decltype(&skerry::compute_element_forces) compute_element_forces;
    decltype(&skerry::elastic_energy) elastic_energy;
    decltype(&skerry::elastic_power) elastic_power;
    decltype(&skerry::cauchy_stress) cauchy_stress;
    decltype(&skerry::element_fields) element_fields;
    decltype(&skerry::element_strains) element_strains;
    decltype(&skerry::stress_of_tetrahedra) stress_of_tetrahedra;
    decltype(&skerry::strain_of_tetrahedra) strain_of_tetrahedra;
    decltype(&skerry::mean_of_tetrahedra) mean_of_tetrahedra;
    decltype(&skerry::yield_elements) yield_elements;
    decltype(&skerry::forget_flow) forget_flow;
    decltype(&skerry::advance_positions) advance_positions;
    decltype(&skerry::damp_velocity) damp_velocity;
    decltype(&skerry::measure_displacement) measure_displacement;
    decltype(&skerry::predict_velocity) predict_velocity;
    decltype(&skerry::kick_clusters) kick_clusters;
    StableStep (*stable_step)(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                              std::span<const Real> mass, std::span<Real> stiffness_sum);
    ElementBounds element_bounds;
    decltype(&skerry::find_relaxation) find_relaxation;
    decltype(&skerry::find_mass_shares) find_mass_shares;
    decltype(&skerry::find_mass_forms) find_mass_forms;
    decltype(&skerry::find_frame_masses) find_frame_masses;
    decltype(&skerry::strained_step) strained_step;
    decltype(&skerry::watch_stable_steps) watch_stable_steps;
    decltype(&skerry::solve_regions) solve_regions;
};

/// The kernels for one instruction set. `runs`: true if this processor and its operating system support the instruction
/// set.
struct KernelSet {
    const Kernels* kernels;
    bool runs;
};

/// The kernel tables of all instruction sets of the build, from the oldest processors to the newest. The first table
/// can always be used, because the rest of the engine is compiled for its instruction set too.
std::span<const KernelSet> kernel_sets();

}  // namespace skerry
