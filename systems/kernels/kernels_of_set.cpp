// Table of the kernels for one instruction set. The build compiles this file once per instruction set. SKERRY_KERNELS
// is the name of the table, SKERRY_KERNELS_FOR the name of the instruction set.
#include "systems/kernels/kernels.h"

// The table has a name without C++ mangling. This name is the only symbol that the objects of an instruction set export
// (cmake/close.cmake).
extern "C" {
extern const skerry::Kernels SKERRY_KERNELS;

const skerry::Kernels SKERRY_KERNELS = {
    .instruction_set = SKERRY_KERNELS_FOR,
    .find_candidates = &skerry::find_candidates,
    .find_contacts = &skerry::find_contacts,
    .find_crossings = &skerry::find_crossings,
    .check_state = &skerry::check_state,
    .strain_rate = &skerry::strain_rate,
    .find_inversions = &skerry::find_inversions,
    .measure_viscosity = &skerry::measure_viscosity,
    .compute_element_forces = &skerry::compute_element_forces,
    .elastic_energy = &skerry::elastic_energy,
    .elastic_power = &skerry::elastic_power,
    .cauchy_stress = &skerry::cauchy_stress,
    .element_fields = &skerry::element_fields,
    .element_strains = &skerry::element_strains,
    .stress_of_tetrahedra = &skerry::stress_of_tetrahedra,
    .strain_of_tetrahedra = &skerry::strain_of_tetrahedra,
    .mean_of_tetrahedra = &skerry::mean_of_tetrahedra,
    .yield_elements = &skerry::yield_elements,
    .forget_flow = &skerry::forget_flow,
    .advance_positions = &skerry::advance_positions,
    .damp_velocity = &skerry::damp_velocity,
    .measure_displacement = &skerry::measure_displacement,
    .predict_velocity = &skerry::predict_velocity,
    .kick_clusters = &skerry::kick_clusters,
    .stable_step = &skerry::stable_step,
    .element_bounds = {},
    .find_relaxation = &skerry::find_relaxation,
    .find_mass_shares = &skerry::find_mass_shares,
    .find_mass_forms = &skerry::find_mass_forms,
    .find_frame_masses = &skerry::find_frame_masses,
    .strained_step = &skerry::strained_step,
    .watch_stable_steps = &skerry::watch_stable_steps,
    .solve_regions = &skerry::solve_regions,
};
}
