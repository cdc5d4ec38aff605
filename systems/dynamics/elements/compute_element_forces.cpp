#include "systems/dynamics/elements/compute_element_forces.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "components/check.h"
#include "components/flush_subnormals.h"
#include "components/prefetch_lines.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/dynamics/elements/idle_guards.h"
#include "systems/dynamics/elements/quick_stiffness.h"
#include "systems/material/extract_rotation.h"
#include "systems/material/maxwell_block.h"
#include "systems/material/viscous_stress.h"
#include "systems/material/with_law.h"

namespace skerry {

namespace {

// Numbers of blocks, and of rows of blocks, by which prefetching is ahead of the computation.
constexpr std::size_t blocks_ahead = 6, rows_ahead = 32;

// Size of a local buffer of node positions (16 kB), which stays in the L1 cache. Patches with more nodes use
// patches.position instead.
constexpr std::size_t nodes_in_buffer = 512;

/// Consecutive blocks of a patch with one material and one part of the stress (ElementPart).
struct Run {
    std::size_t begin, end;
    const ElementInputs& elements;
    MaterialConstants material;
    Real kick;  // s
    MaxwellStep maxwell;
    PatchRows<const Real> position;  // positions of the nodes of the patch [m]
    PatchRows<Real> force;           // forces on the nodes of the patch [N]
    std::span<const Vec3> velocity;  // velocities of all nodes [m/s]
    std::span<const ElementRotation> rotation;
    const ElementMemory& next;
    const PatchForces& patches;

    /// Rows of a block, with nodes given as slots of the patch.
    BlockNodes nodes_of(std::size_t block) const {
        const auto row = static_cast<std::size_t>(elements.first[block]);
        return {patches.slot.data() + row, elements.gradient.data() + row, elements.count[block]};
    }

    /// Prefetches a later row of nodes, which may belong to another patch. Processors do not recognise that these rows
    /// are consecutive, because other loads lie between them. The distance is a fixed number of rows: finding the rows
    /// of a certain later block would take more instructions than the prefetches.
    [[gnu::always_inline]] static void prefetch_row_ahead_of(const BlockNodes& nodes, Index k) {
        prefetch_lines_ahead(nodes.gradient + k, rows_ahead, 1);
        prefetch_lines_ahead(nodes.node + k, rows_ahead, 1);
    }

    template <class T>
    static T load_lanes(std::span<const ElementLane> column, std::size_t block, std::size_t part) {
        return load_part<T>(column[block], part);
    }

    bool relaxes() const { return material.relaxes() && !next.spring_strain.empty(); }

    /// Relaxes the springs of the Maxwell elements and writes their strains. Returns their second Piola-Kirchhoff
    /// stress, divided by maxwell.modulus. `scale`: minus the volume of the element. Adds the dissipated energy to
    /// `relaxed`, which dissipated_of() converts to joules.
    [[gnu::always_inline]] LaneSymmetric<Float8> relax_springs(std::size_t block, const Parts<LaneMat3<KernelReal>>& F,
                                                               const Parts<KernelReal>& scale,
                                                               Parts<KernelReal>& relaxed) const {
        using T = KernelReal;
        Parts<T> xx, yy, zz, xy, yz, zx, relaxes_volume;
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneSymmetric<T> E = twice_green_strain(F[part]);
            xx[part] = E.xx, yy[part] = E.yy, zz[part] = E.zz;
            xy[part] = E.xy, yz[part] = E.yz, zx[part] = E.zx;
            relaxes_volume[part] = (kick / bulk_time) * load_lanes<T>(elements.own_frequency, block, part);
        }
        Float8 dissipated;
        const LaneSymmetric<Float8> stress =
            relax(maxwell, {floats_of(xx), floats_of(yy), floats_of(zz), floats_of(xy), floats_of(yz), floats_of(zx)},
                  floats_of(relaxes_volume), elements.spring_strain[block], next.spring_strain[block], blocks_ahead,
                  dissipated);
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part)
            relaxed[part] = relaxed[part] + scale[part] * part_of(dissipated, part);
        return stress;
    }

    /// Rotations R nearest to F, as quaternions, and the traces of R^T F. The iteration runs for all lanes of a block
    /// together. Its number of steps, and with it the bits of the result, then do not depend on the register width.
    struct Frames {
        Parts<LaneQuaternion<KernelReal>> q;
        Parts<KernelReal> trace;
    };
    template <class Law>
    [[gnu::always_inline]] Frames extract_frames(std::size_t block, const Parts<LaneMat3<KernelReal>>& F) const {
        Frames frames;
        if constexpr (Law::has_frame) {
            Parts<KernelReal> volume;
#pragma GCC unroll 2
            for (std::size_t part = 0; part < kernel_parts; ++part) {
                frames.q[part] = load_part<KernelReal>(rotation[block], part);
                volume[part] = load_lanes<KernelReal>(elements.volume, block, part);
            }
            frames.trace = extract_rotations(F, volume, frames.q);
#pragma GCC unroll 2
            for (std::size_t part = 0; part < kernel_parts; ++part)
                store_part(frames.q[part], next.rotation[block], part);
        }
        return frames;
    }

    /// Elastic stress of the elements in one part of a block, which fills a register [Pa].
    template <class Law>
    [[gnu::always_inline]] auto elastic_stress(const Law& law, const LaneMat3<KernelReal>& F, const Frames& frames,
                                               std::size_t part) const {
        if constexpr (Law::has_frame)
            return law.stress(material, rotation_of(frames.q[part]), frames.trace[part]);
        else
            return law.stress(material, F);
    }

    /// True for implicit elements so near to their rest shape that they have no viscosity. `square`: |F|^2, `J`: det F.
    template <class T>
    static auto is_small_strain(const T& square, const T& J) {
        constexpr Real stretched = 6, pressed = 0.3;  // upper limit of |F|^2, lower limit of det F; 3 and 1 at rest
        return (square < stretched) & (J > pressed);
    }

    /// True if the block has implicit elements, none of them is viscous, and the stiffness of none is near its assumed
    /// stiffness. The result is true for most blocks with implicit elements in most steps.
    template <class Law>
    [[gnu::always_inline]] bool is_near_rest(const Law& law, std::size_t block,
                                             const Parts<LaneMat3<KernelReal>>& F) const {
        bool any_implicit = false, easy = true;
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal square = inner_product(F[part], F[part]), J = determinant(F[part]),
                             assumed = load_lanes<KernelReal>(elements.implicit_modulus, block, part);
            const auto near_rest =
                is_small_strain(square, J) & (quick_stiffness(law, material, square, J) <= near_stiffness * assumed);
            easy &= all((assumed <= 0.0) | near_rest);
            any_implicit |= !all(assumed <= 0.0);
        }
        return any_implicit && easy;
    }

    /// Computes the viscosity of implicit elements [Pa s]. It is positive if an element is strongly stretched or
    /// compressed, else 0. Returns true if any element is viscous.
    bool viscosity_of_implicit(std::size_t block, const Parts<LaneMat3<KernelReal>>& F,
                               Parts<KernelReal>& viscosity) const {
        ElementLane lanes{};
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal strain_modulus =
                elements.viscous_time[block] * load_lanes<KernelReal>(elements.implicit_modulus, block, part);
            viscosity[part] =
                is_small_strain(inner_product(F[part], F[part]), determinant(F[part])) ? KernelReal{} : strain_modulus;
            store_part(viscosity[part], lanes, part);
        }
        return std::ranges::any_of(lanes.lane, [](Real value) { return value > 0; });
    }

    /// True if an implicit element is strained so much that its stiffness must be computed accurately.
    bool is_stiffening(std::size_t block, const Parts<LaneMat3<KernelReal>>& F) const {
        bool any = false;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const KernelReal assumed = load_lanes<KernelReal>(elements.implicit_modulus, block, part);
            any |= !all((assumed <= 0.0) | (quick_stiffness(material, inner_product(F[part], F[part]),
                                                            determinant(F[part])) <= near_stiffness * assumed));
        }
        return any;
    }

    void record(std::size_t block, bool viscous, bool stiffening) const {
        if (!patches.viscous.empty()) patches.viscous[block] = viscous;
        if (!patches.stiffening.empty()) patches.stiffening[block] = stiffening;
    }

    /// Adds the viscous stress of the implicit elements of a block, times `scale`, to Q, and stores the viscous
    /// impulse.
    void add_viscous_stress(std::size_t block, const Parts<LaneMat3<KernelReal>>& F, const Parts<KernelReal>& scale,
                            Parts<LaneMat3<KernelReal>>& Q) const {
        Parts<KernelReal> viscosity;
        const bool acts = viscosity_of_implicit(block, F, viscosity);
        record(block, acts, is_stiffening(block, F));
        if (!acts) return;
        for (std::size_t part = 0; part < kernel_parts; ++part) {
            const LaneMat3<KernelReal> rate = deformation_gradient(elements.nodes_of(block), part, velocity);
            const LaneMat3<KernelReal> rate_stress = viscous_stress(viscosity[part], F[part], rate);
            if (!patches.viscous_impulse.empty()) keep_impulse(rate_stress, block, part);
            Q[part] = Q[part] + scale[part] * rate_stress;
        }
    }

    [[gnu::noinline]] static Parts<LaneMat3<KernelReal>> with_viscous_stress(Run run, std::size_t block,
                                                                             Parts<LaneMat3<KernelReal>> F,
                                                                             Parts<KernelReal> scale,
                                                                             Parts<LaneMat3<KernelReal>> Q) {
        run.add_viscous_stress(block, F, scale, Q);
        return Q;
    }

    void keep_impulse(const LaneMat3<KernelReal>& stress, std::size_t block, std::size_t part) const {
        ElementViscousImpulse& impulse = patches.viscous_impulse[block];
        const KernelReal scale = kick * load_lanes<KernelReal>(elements.volume, block, part);
        const KernelReal entry[9] = {stress.c0.x, stress.c0.y, stress.c0.z, stress.c1.x, stress.c1.y,
                                     stress.c1.z, stress.c2.x, stress.c2.y, stress.c2.z};
        for (std::size_t i = 0; i < 9; ++i) store_part(KernelReal(scale * entry[i]), impulse[i], part);
    }

    /// Factor from stress to nodal forces: minus the volume of the element [m^3].
    [[gnu::always_inline]] Parts<KernelReal> scale_of(std::size_t block) const {
        Parts<KernelReal> scale;
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part)
            scale[part] = -load_lanes<KernelReal>(elements.volume, block, part);
        return scale;
    }

    /// Total first Piola-Kirchhoff stress of the elements of a block, times minus their volume [Pa m^3]. Adds the
    /// dissipation of the springs to `relaxed`, in the unit that dissipated_of() converts to joules.
    template <class Law>
    [[gnu::always_inline]] Parts<LaneMat3<KernelReal>> stress_of(const Law& law, std::size_t block,
                                                                 const Parts<LaneMat3<KernelReal>>& F,
                                                                 Parts<KernelReal>& relaxed) const {
        const Parts<KernelReal> scale = scale_of(block);
        const Frames frames = extract_frames<Law>(block, F);
        const auto elastic = [&](std::size_t part) __attribute__((always_inline)) {
            return scaled(scale[part], elastic_stress(law, F[part], frames, part));
        };
        Parts<LaneMat3<KernelReal>> Q;
        if (relaxes()) {
            const LaneSymmetric<Float8> springs = relax_springs(block, F, scale, relaxed);
#pragma GCC unroll 2
            for (std::size_t part = 0; part < kernel_parts; ++part) {
                const LaneSymmetric<KernelReal> S = KernelReal(maxwell.modulus * scale[part]) * part_of(springs, part);
                Q[part] = multiply_and_add(F[part], S, elastic(part));
            }
        } else {
#pragma GCC unroll 2
            for (std::size_t part = 0; part < kernel_parts; ++part) Q[part] = whole(elastic(part), F[part]);
        }
        if (!elements.viscous_time.empty() && elements.viscous_time[block] > 0) {
            // with_viscous_stress() takes the addresses of its arguments. Without the copies gcc would therefore keep F
            // and Q in memory, even in blocks without viscosity. It would also store intermediate results of the stress
            // for is_near_rest().
            if (is_near_rest(law, block, copy_of_parts(F)))
                record(block, false, false);
            else
                Q = copy_of_parts(
                    with_viscous_stress(*this, block, copy_of_parts(F), scale_of(block), copy_of_parts(Q)));
        }
        return Q;
    }

    /// Dissipated energy from the sum over the elements [J]. relax() gives the energies per volume divided by a quarter
    /// of maxwell.modulus. The minus sign is needed because `scale` is negative.
    Real dissipated_of(const Parts<KernelReal>& sum) const {
        return -0.25 * maxwell.modulus * sum_of_parts(sum);
    }

    /// Deformation gradients F of the elements of a block.
    [[gnu::always_inline]] Parts<LaneMat3<KernelReal>> fetch(std::size_t block) const {
        const BlockNodes nodes = nodes_of(block);
        Parts<LaneMat3<KernelReal>> F;
#pragma GCC unroll 2
        for (std::size_t part = 0; part < kernel_parts; ++part) F[part] = deformation_gradient(nodes, part, position);
        return F;
    }

    /// Adds the forces of the elements of a block to the forces on their nodes. `Q`: stress times minus the volume.
    [[gnu::always_inline]] void add_forces(std::size_t block, const Parts<LaneMat3<KernelReal>>& Q) const {
        const BlockNodes nodes = nodes_of(block);
        const auto take = [&](Index k, std::size_t part, const LaneVec3<KernelReal>& f) __attribute__((always_inline)) {
            if (part == 0) prefetch_row_ahead_of(nodes, k);
            add_lanes(f, nodes.node[k].lane + lanes_of<KernelReal> * part, force);
        };
        for_each_force(Q, nodes, take);
    }
};

/// Computes the forces of a run of blocks. Returns the energy that the dashpots of the elements dissipate [J].
[[gnu::always_inline]] inline Real compute_run(const Run& run) {
    // True: the next block is fetched before the forces of the present block are added. These two operations are
    // independent, while the stress between them is a long chain. Narrow registers are too few to hold two blocks.
    constexpr bool ahead = kernel_parts == 1;
    Parts<KernelReal> relaxed{};
    with_law(run.material.model, [&](auto law) {
        Parts<LaneMat3<KernelReal>> F = run.fetch(run.begin);
        for (std::size_t block = run.begin; block < run.end; ++block) {
            const Parts<LaneMat3<KernelReal>> Q = run.stress_of(law, block, F, relaxed);
            const bool has_next = block + 1 < run.end;
            if (ahead && has_next) F = run.fetch(block + 1);
            run.add_forces(block, Q);
            if (!ahead && has_next) F = run.fetch(block + 1);
        }
    });
    return run.dissipated_of(relaxed);
}

/// Copies the positions of the nodes of a patch to padded rows, and sets the forces on these nodes to zero. `node` must
/// be ascending.
void copy_positions(std::span<const Index> node, std::span<const Vec3> position, PaddedVec3* to, PaddedVec3* force) {
    SKERRY_CHECK(!node.empty());
    std::fill_n(force, node.size(), PaddedVec3{});
    const auto at = [&](std::size_t s) -> const Vec3& { return position[static_cast<std::size_t>(node[s])]; };
    // The last position is copied number by number, because load_position reads one number past the position. The last
    // row of the list belongs to the node with the highest row of NodeTable, for which this number may lie beyond the
    // end of `position`.
    const std::size_t last = node.size() - 1;
    for (std::size_t s = 0; s < last; ++s) store_half(load_position(&at(s)), to[s].lane);
    to[last] = {{at(last)[0], at(last)[1], at(last)[2], 0}};
}

/// First block after `begin` whose material or part of the stress (ElementPart) differs from that of block `begin`;
/// `end` if there is none.
std::size_t end_of_run(const ElementInputs& elements, std::size_t begin, std::size_t end) {
    std::size_t b = begin + 1;
    while (b < end && elements.material[b] == elements.material[begin] && elements.part[b] == elements.part[begin]) ++b;
    return b;
}

}  // namespace

Real compute_element_forces(Executor& executor, const ElementInputs& elements, std::span<const Vec3> position,
                            std::span<const Vec3> velocity, Real kick, std::span<const ElementRotation> rotation,
                            const ElementMemory& next, const PatchForces& patches) {
    SKERRY_CHECK(patches.force.size() == patches.node.size() && patches.position.size() == patches.node.size());
    SKERRY_CHECK(rotation.size() == elements.blocks() && next.rotation.size() == elements.blocks());
    SKERRY_CHECK(elements.viscous_time.empty() || elements.implicit_modulus.size() == elements.blocks());
    parallel_for(executor, patches.blocks.size(), 1, [&](std::size_t first, std::size_t last) {
        const FlushSubnormals flush;  // decaying strains of springs would become subnormal numbers, which are slow
        for (std::size_t p = first; p < last; ++p) {
            const auto begin = static_cast<std::size_t>(patches.blocks[p].begin),
                       end = static_cast<std::size_t>(patches.blocks[p].end);
            if (!patches.relaxed.empty()) patches.relaxed[p] = 0;
            const auto slot = static_cast<std::size_t>(patches.slots[p].begin);
            const auto node = patches.node.subspan(slot, static_cast<std::size_t>(patches.slots[p].size()));
            const bool idle = is_idle(elements, begin, end);
            if (idle) std::ranges::fill(patches.force.subspan(slot, node.size()), PaddedVec3{});
            if (idle || elements.is_left_out(begin)) continue;
            std::array<PaddedVec3, nodes_in_buffer> near;
            PaddedVec3 *const x = node.size() <= nodes_in_buffer ? near.data() : patches.position.data() + slot,
                              *const force = patches.force.data() + slot;
            copy_positions(node, position, x, force);
            for (std::size_t b = begin; b < end;) {
                const std::size_t after = end_of_run(elements, b, end);
                const MaterialConstants material = elements.material_of(b);
                const bool has_rates = !elements.relaxation_rate.empty();
                const MaxwellStep maxwell(material, has_rates ? elements.relaxation_rate[b] : RelaxationRates{},
                                          has_rates ? elements.relaxing_share[b] : 0, kick);
                const Run run{b,         after,         elements, material, kick, maxwell,
                              {x->lane}, {force->lane}, velocity, rotation, next, patches};
                const Real relaxed = compute_run(run);
                if (!patches.relaxed.empty() && !elements.is_of_ghost(b)) patches.relaxed[p] += relaxed;
                b = after;
            }
        }
    });
    const auto relaxes = [](const MaterialConstants& material) { return material.relaxes(); };
    if (std::ranges::none_of(elements.constants, relaxes)) return 0;
    // The sum runs in the order of patches, so that its bits do not depend on the number of workers.
    return std::accumulate(patches.relaxed.begin(), patches.relaxed.end(), Real{0});
}

}  // namespace skerry
