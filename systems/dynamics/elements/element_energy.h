// Computes energies and stresses of the present state, for reports and output.
#pragma once

#include <span>

#include "components/body_table.h"
#include "systems/dynamics/elements/compute_element_forces.h"

namespace skerry {

/// Elastic energy of the elements in a range of blocks, including the springs of their Maxwell elements [J].
/// Sequential, in element order.
Real elastic_energy(const ElementInputs& elements, Range blocks, std::span<const Vec3> position);

/// Power of the elastic stress of the elements in a range of blocks at given node velocities, including the springs of
/// their Maxwell elements [W]. Sequential, in element order.
Real elastic_power(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                   std::span<const Vec3> velocity);

/// Writes the Cauchy stress of each element in a range of blocks to stress[8 (block - blocks.begin) + lane] [Pa]. The
/// stress of Maxwell elements is not included.
void cauchy_stress(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<Mat3> stress);

struct ElementFields {
    Mat3 gradient;                       // deformation gradient F
    Mat3 nominal_stress, cauchy_stress;  // nominal: first Piola-Kirchhoff; without Maxwell elements [Pa]
    Mat3 strain;                         // Green strain
};

/// Writes the fields of the elements in some blocks of a range. `requested`: numbers of the blocks to evaluate,
/// ascending, counted from blocks.begin. Block requested[i] is written to fields[8 i + lane]. The values do not depend
/// on which other blocks are requested.
void element_fields(const ElementInputs& elements, Range blocks, std::span<const Index> requested,
                    std::span<const Vec3> position, std::span<ElementFields> fields);

/// Writes Green's strain (F^T F - I) / 2 of each element to strain[8 (block - blocks.begin) + lane]; zero in lanes
/// without volume.
void element_strains(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<Mat3> strain);

/// Von Mises stress of a Cauchy stress tensor [Pa].
Real von_mises(const Mat3& cauchy);

/// Principal stresses of a Cauchy stress tensor, the largest first; tension is positive [Pa].
Vec3 principal_stresses(const Mat3& cauchy);

}  // namespace skerry
