#include "systems/dynamics/compute_element_forces.h"

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/element_block.h"
#include "systems/material/corotational.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/linear.h"
#include "systems/material/stable_neo_hookean.h"

namespace skerry {

namespace {

constexpr std::size_t blocks_per_job = 64;  // 512 tetrahedra, some 4 us: well above the cost of handing out a job

}  // namespace

void compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const ElementRotation> rotation, std::span<ElementRotation> rotation_next,
                            std::span<ElementForces> force) {
    SKERRY_CHECK(force.size() == elements.node.size() && rotation.size() == force.size() && rotation_next.size() == force.size());
    parallel_for(executor, elements.node.size(), blocks_per_job, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const ElementRest& B = elements.inverse_rest[b];
            const MaterialConstants& material = elements.constants[static_cast<std::size_t>(elements.material[b])];
            const Real8 volume = load(elements.volume[b]);
            const LaneMat3<Real8> F = deformation_gradient(edges(elements.node[b], position), B);
            switch (material.model) {
                case MaterialModel::linear:
                    spread_forces(linear::stress(material, F), B, volume, force[b]);
                    break;
                case MaterialModel::corotational: {
                    LaneQuaternion<Real8> q = load(rotation[b]);
                    extract_rotation(F, volume, q);
                    store(q, rotation_next[b]);
                    spread_forces(corotational::stress(material, F, rotation_of(q)), B, volume, force[b]);
                    break;
                }
                case MaterialModel::stable_neo_hookean:
                    spread_forces(stable_neo_hookean::stress(material, F), B, volume, force[b]);
                    break;
            }
        }
    });
}

}  // namespace skerry
