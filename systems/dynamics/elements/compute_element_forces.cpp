#include "systems/dynamics/elements/compute_element_forces.h"

#include <algorithm>
#include <numeric>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/elements/quick_stiffness.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/relaxation.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

template <class T>
[[gnu::always_inline]] inline LaneMat3<T> transposed(const LaneMat3<T>& a) {
    return {{a.c0.x, a.c1.x, a.c2.x}, {a.c0.y, a.c1.y, a.c2.y}, {a.c0.z, a.c1.z, a.c2.z}};
}

/// Stress of the strain rate, F S with S = time (2 mu E' + lambda tr(E') I) and E' = (F^T F' + F'^T F) / 2: nothing in
/// rigid motion, and no torque, since F S F^T is symmetric.
template <class T>
LaneMat3<T> viscous_stress(const MaterialConstants& material, Real time, const LaneMat3<T>& F,
                           const LaneMat3<T>& F_rate) {
    const LaneMat3<T> product = multiply(transposed(F), F_rate);
    LaneMat3<T> S = (time * material.shear_modulus) * (product + transposed(product));
    const T pressure = (time * material.lame_lambda) * (product.c0.x + product.c1.y + product.c2.z);
    S.c0.x += pressure;
    S.c1.y += pressure;
    S.c2.z += pressure;
    return multiply(F, S);
}

/// Stress of the strain rate in implicit elements, F E' viscosity/|F|^2: at most viscosity |F'| however much they are
/// deformed, which their inertia is made for (docs/methods/clusters.md 2).
template <class T>
LaneMat3<T> bounded_viscous_stress(const T& viscosity, const LaneMat3<T>& F, const LaneMat3<T>& F_rate) {
    constexpr Real tiny = 1e-6;  // |F|^2 of a point, and of lanes that are left over
    const LaneMat3<T> product = multiply(transposed(F), F_rate);
    const T scale = viscosity / (2.0 * inner_product(F, F) + tiny);
    return multiply(F, scale * (product + transposed(product)));
}

/// A block of elements in this step, of which a part is computed at a time.
struct Block {
    const ElementInputs& elements;
    std::size_t block;
    BlockNodes nodes;  // among the positions and forces of the patch
    const PaddedVec3* position;
    PaddedVec3* force;
    MaterialConstants material;
    Real duration;  // in steps
    Real h;         // s, a step

    template <class T>
    T part_of(std::span<const ElementLane> column, std::size_t part) const {
        return load_part<T>(column[block], part);
    }

    /// The dashpots give way for as long as the block is due, then the springs push. Returns the stress, Pa, and writes
    /// what the dashpots have taken and what they dissipated, J.
    template <class T>
    [[gnu::always_inline]] LaneMat3<T> relax(const LaneMat3<T>& F, std::size_t part, ElementStrain& forgotten_next,
                                             ElementLane& dissipated) const {
        const ViscousModuli moduli = viscous_moduli(material, elements.relaxing_share[block]);
        const LaneSymmetric<T> strain = green_strain(F);
        const ViscousStretch<T> before = viscous_stretch(strain, elements.viscous_strain[block], part);
        const Real time = duration * h;
        // backward Euler: never more than all
        const ViscousStretch<T> after{
            T(1.0 / (1.0 + time * part_of<T>(elements.relaxation_rate, part))) * before.strain,
            before.volume / (1.0 + (time / bulk_time) * part_of<T>(elements.own_frequency, part))};
        const LaneSymmetric<T> next = strain - after.strain;
        store_part(next.xx, forgotten_next[0], part);
        store_part(next.yy, forgotten_next[1], part);
        store_part(next.zz, forgotten_next[2], part);
        store_part(next.xy, forgotten_next[3], part);
        store_part(next.yz, forgotten_next[4], part);
        store_part(next.zx, forgotten_next[5], part);
        store_part(T(strain.trace() - after.volume), forgotten_next[6], part);
        // What the springs, as stretched as they push, do to the dashpots. Not the drop of their energy: the kick that
        // follows is by so much weaker, which velocities half a step off the positions do not show yet.
        store_part(T(part_of<T>(elements.volume, part) *
                     work_density(moduli, after, {before.strain - after.strain, before.volume - after.volume})),
                   dissipated, part);
        return multiply(F, stress(moduli, after));
    }

    /// Elastic stress, Pa. Frames are extracted from all parts at once: how often their steps are repeated does not
    /// depend on the width of a part.
    [[gnu::always_inline]] Parts<LaneMat3<KernelReal>> elastic_stress(const Parts<LaneMat3<KernelReal>>& F,
                                                                      std::span<const ElementRotation> rotation,
                                                                      const ElementMemory& next) const {
        using T = KernelReal;
        return with_law(material.model, [&](auto law) {
            Parts<LaneMat3<T>> P;
            if constexpr (law.has_frame) {
                Parts<LaneQuaternion<T>> q;
                Parts<T> volume;
                for (std::size_t part = 0; part < kernel_parts; ++part) {
                    q[part] = load_part<T>(rotation[block], part);
                    volume[part] = part_of<T>(elements.volume, part);
                }
                extract_rotations(F, volume, q);
                for (std::size_t part = 0; part < kernel_parts; ++part) {
                    store_part(q[part], next.rotation[block], part);
                    P[part] = law.stress(material, F[part], rotation_of(q[part]));
                }
            } else {
                for (std::size_t part = 0; part < kernel_parts; ++part) P[part] = law.stress(material, F[part]);
            }
            return P;
        });
    }

    /// Of implicit elements of this |F|^2 and det F: whether they are near enough to rest to have no viscosity.
    template <class T>
    static auto is_calm(const T& square, const T& J) {
        constexpr Real stretched = 6, pressed = 0.3;  // 3 and 1 at rest
        return (square < stretched) & (J > pressed);
    }

    /// Whether all elements of the block are implicit ones far from what they are made for, or explicit ones beside
    /// such: most are, in most steps.
    [[gnu::always_inline]] bool rests_easy(const Parts<LaneMat3<KernelReal>>& F) const {
        if (elements.implicit_modulus.empty()) return false;
        bool any_implicit = false, easy = true;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal square = inner_product(F[part], F[part]), J = determinant(F[part]),
                             taken = part_of<KernelReal>(elements.implicit_modulus, part);
            const auto near_rest =
                is_calm(square, J) & (quick_stiffness(material, square, J) <= near_stiffness * taken);
            easy &= all((taken <= 0.0) | near_rest);
            any_implicit |= !all(taken <= 0.0);
        }
        return any_implicit && easy;
    }

    bool has_implicit() const {
        return !elements.implicit_modulus.empty() &&
               std::ranges::any_of(elements.implicit_modulus[block].lane, [](Real modulus) { return modulus > 0; });
    }

    /// Pa s, of implicit elements that are stretched or pressed by much; 0 of the others. Returns whether any is.
    bool viscosity_of_implicit(const Parts<LaneMat3<KernelReal>>& F, Parts<KernelReal>& viscosity) const {
        ElementLane lanes{};
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal of_modulus =
                elements.viscous_time[block] * part_of<KernelReal>(elements.implicit_modulus, part);
            viscosity[part] =
                is_calm(inner_product(F[part], F[part]), determinant(F[part])) ? KernelReal{} : of_modulus;
            store_part(viscosity[part], lanes, part);
        }
        return std::ranges::any_of(lanes.lane, [](Real of) { return of > 0; });
    }

    /// Whether an implicit element is so strained that its stiffness has to be looked at closely.
    bool is_stiffening(const Parts<LaneMat3<KernelReal>>& F) const {
        bool any = false;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal taken = part_of<KernelReal>(elements.implicit_modulus, part);
            any |= !all((taken <= 0.0) | (quick_stiffness(material, inner_product(F[part], F[part]),
                                                          determinant(F[part])) <= near_stiffness * taken));
        }
        return any;
    }

    void note(const PatchForces& patches, bool viscous, bool stiffening) const {
        if (!patches.viscous.empty()) patches.viscous[block] = viscous;
        if (!patches.stiffening.empty()) patches.stiffening[block] = stiffening;
    }

    /// Adds the stress of the strain rate where there is one, and keeps its impulse.
    [[gnu::noinline]] void add_viscous_stress(const Parts<LaneMat3<KernelReal>>& F, std::span<const Vec3> velocity,
                                              const PatchForces& patches, Parts<LaneMat3<KernelReal>>& P) const {
        const bool implicit = has_implicit();
        Parts<KernelReal> viscosity;
        const bool acts = !implicit || viscosity_of_implicit(F, viscosity);
        note(patches, acts, implicit && is_stiffening(F));
        if (!acts) return;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneMat3<KernelReal> rate = deformation_gradient(elements.nodes_of(block), part, velocity);
            const LaneMat3<KernelReal> of_rate =
                implicit ? bounded_viscous_stress(viscosity[part], F[part], rate)
                         : viscous_stress(material, elements.viscous_time[block], F[part], rate);
            if (!patches.viscous_impulse.empty()) keep_impulse(of_rate, part, patches.viscous_impulse[block]);
            P[part] = P[part] + of_rate;
        }
    }

    void keep_impulse(const LaneMat3<KernelReal>& stress, std::size_t part, ElementViscousImpulse& impulse) const {
        const KernelReal scale = (duration * h) * part_of<KernelReal>(elements.volume, part);
        const KernelReal entry[9] = {stress.c0.x, stress.c0.y, stress.c0.z, stress.c1.x, stress.c1.y,
                                     stress.c1.z, stress.c2.x, stress.c2.y, stress.c2.z};
        for (std::size_t i = 0; i < 9; ++i) store_part(KernelReal(scale * entry[i]), impulse[i], part);
    }

    [[gnu::always_inline]] void add_forces(std::span<const Vec3> velocity, std::span<const ElementRotation> rotation,
                                           const ElementMemory& next, ElementLane& dissipated,
                                           const PatchForces& patches) const {
        Parts<LaneMat3<KernelReal>> F;
        for (std::size_t part = 0; part < kernel_parts; ++part) F[part] = deformation_gradient(nodes, part, position);
        Parts<LaneMat3<KernelReal>> P = elastic_stress(F, rotation, next);
        if (!elements.viscous_time.empty() && elements.viscous_time[block] > 0) {
            if (rests_easy(F))
                note(patches, false, false);
            else
                add_viscous_stress(F, velocity, patches, P);
        }
        Parts<KernelReal> volume;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            if (material.relaxes() && !next.viscous_strain.empty())
                P[part] = P[part] + relax(F[part], part, next.viscous_strain[block], dissipated);
            volume[part] = duration * part_of<KernelReal>(elements.volume, part);
        }
        for_each_force(P, nodes, volume, [&](Index k, std::size_t part, const LaneVec3<KernelReal>& f) {
            add_lanes(f, nodes.node[k].lane + lanes_of<KernelReal> * part, force);
        });
    }
};

/// The same order however many lanes are computed at once.
Real sum_of(const ElementLane& lanes) {
    const Real* const x = lanes.lane;
    return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

/// Positions of the nodes of a patch side by side, and forces zero.
void fetch(std::span<const Index> node, std::span<const Vec3> position, PaddedVec3* to, PaddedVec3* force) {
    for (std::size_t s = 0; s < node.size(); ++s) {
        const Vec3& x = position[static_cast<std::size_t>(node[s])];
        to[s] = {{x[0], x[1], x[2], 0}};
        force[s] = {};
    }
}

}  // namespace

Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real h, std::span<const ElementRotation> rotation,
                            const ElementMemory& next, const PatchForces& patches) {
    SKERRY_CHECK(patches.force.size() == patches.node.size() && patches.position.size() == patches.node.size());
    SKERRY_CHECK(rotation.size() == elements.blocks() && next.rotation.size() == elements.blocks());
    parallel_for(executor, patches.blocks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            const auto begin = static_cast<std::size_t>(patches.blocks[p].begin),
                       end = static_cast<std::size_t>(patches.blocks[p].end);
            const bool touched = !patches.touched.empty() && patches.touched[p];
            if (!touched && elements.schedule.duration(begin) == 0) {
                if (!next.relaxed.empty()) std::fill(next.relaxed.begin() + begin, next.relaxed.begin() + end, Real{0});
                continue;
            }
            const auto slot = static_cast<std::size_t>(patches.slots[p].begin);
            PaddedVec3 *const x = patches.position.data() + slot, *const force = patches.force.data() + slot;
            fetch(patches.node.subspan(slot, static_cast<std::size_t>(patches.slots[p].size())), position, x, force);
            for (std::size_t b = begin; b < end; ++b) {
                BlockNodes nodes = elements.nodes_of(b);
                nodes.node = patches.slot.data() + static_cast<std::size_t>(elements.first[b]);
                const Real duration = elements.schedule.duration(b);
                ElementLane dissipated{};
                if (duration > 0) {
                    const Block block{elements, b, nodes, x, force, elements.material_of(b), duration, h};
                    block.add_forces(velocity, rotation, next, dissipated, patches);
                }
                if (!next.relaxed.empty()) next.relaxed[b] = sum_of(dissipated);
            }
        }
    });
    const auto relaxes = [](const MaterialConstants& material) { return material.relaxes(); };
    if (std::ranges::none_of(elements.constants, relaxes)) return 0;
    return std::accumulate(next.relaxed.begin(), next.relaxed.end(), Real{0});  // in order
}

}  // namespace skerry
