#include "systems/dynamics/elements/yield_elements.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "components/check.h"
#include "jobs/parallel_for.h"
#include "systems/dynamics/elements/element_block.h"
#include "systems/material/ogden.h"
#include "systems/material/relaxation.h"

namespace skerry {

namespace {

/// Changes of the elements of a block by plastic flow. Lanes that do not flow have the unit matrix and zeros.
struct Flow {
    bool any = false;
    LaneMat3<Real8> inverse;   // inverse of the plastic deformation in this return, symmetric, with determinant 1
    Real8 strain, dissipated;  // increase of the equivalent plastic strain; plastic work per volume [J/m^3]
};

/// Radial return of the elements of a block with the elastic deformation gradient F.
Flow flow_of(const MaterialConstants& material, const Real8& volume, const LaneMat3<Real8>& F,
             const Real8& plastic_strain) {
    // Stresses that exceed the yield stress by less than this fraction do so because of rounding errors of an earlier
    // radial return.
    constexpr Real rounding = 1e-10;
    const Real mu = material.shear_modulus;
    const Real8 zero{}, one = zero + 1.0;
    const LaneAxes<Real8> axes = principal_axes(F);
    const LaneVec3<Real8>& s = axes.stretch;
    const auto regular = (volume > 0.0) & (s.z >= Ogden::least_stretch) & (s.x * s.y * s.z >= Ogden::least_volume);
    LaneVec3<Real8> e{log_of(regular ? s.x : one), log_of(regular ? s.y : one), log_of(regular ? s.z : one)};
    const Real8 mean = (e.x + e.y + e.z) * (1.0 / 3);
    e = {e.x - mean, e.y - mean, e.z - mean};
    const Real8 square = dot(e, e), stress = mu * square_root(6.0 * square),  // von Mises stress times det F
        limit = material.yield_stress + material.hardening * plastic_strain;
    const auto flows = stress > (1 + rounding) * limit;
    Flow flow;
    flow.strain = flows ? (stress - limit) / (3 * mu + material.hardening) : zero;
    for (std::size_t l = 0; l < element_lanes; ++l) flow.any |= flow.strain[l] > 0;
    if (!flow.any) return flow;
    const Real8 ratio = 3 * mu * flow.strain / (flows ? stress : one), x = exp_of(-ratio * e.x),
                y = exp_of(-ratio * e.y), z = 1.0 / (x * y);
    const LaneVec3<Real8>&a = axes.right.c0, &b = axes.right.c1, &c = axes.right.c2;
    const auto column = [&](const Real8& ai, const Real8& bi, const Real8& ci) {
        return (x * ai) * a + (y * bi) * b + (z * ci) * c;
    };
    const LaneMat3<Real8> flow_inverse{column(a.x, b.x, c.x), column(a.y, b.y, c.y), column(a.z, b.z, c.z)};
    const auto masked = [&](const LaneVec3<Real8>& v, const Real8& i, const Real8& j, const Real8& k) {
        return LaneVec3<Real8>{flows ? v.x : i, flows ? v.y : j, flows ? v.z : k};
    };
    flow.inverse = {masked(flow_inverse.c0, one, zero, zero), masked(flow_inverse.c1, zero, one, zero),
                    masked(flow_inverse.c2, zero, zero, one)};
    flow.dissipated = (limit + 0.5 * material.hardening * flow.strain) * flow.strain;
    return flow;
}

/// Work of the springs of the Maxwell elements on the plastic flow, per volume [J/m^3]: the mean of their stresses in
/// the last step and after the flow, times the decrease of the elastic strain by the flow. `trial`, `F`: elastic
/// deformation gradient before and after the flow.
Real8 work_of_springs(const ElementInputs& elements, std::size_t block, const MaterialConstants& material,
                      const LaneMat3<Real8>& trial, const LaneMat3<Real8>& F) {
    const SpringStrain& last = elements.spring_strain[block];
    const ViscousModuli moduli = viscous_moduli(material, elements.relaxing_share[block]);
    const auto stress_at = [&](const LaneSymmetric<Real8>& strain) {
        return stress(moduli, springs_in(strain, last).sum());
    };
    const LaneSymmetric<Real8> before{load_reals(last[0]), load_reals(last[1]), load_reals(last[2]),
                                      load_reals(last[3]), load_reals(last[4]), load_reals(last[5])},
        after = twice_green_strain(F);
    // 1/4 contains 1/2 for the mean and 1/2 for doubled strains
    return 0.25 * inner_product(stress_at(before) + stress_at(after), twice_green_strain(trial) - after);
}

/// Changes the rest shape of the elements of a block: each gradient g becomes M^T g, each mass form Q becomes M^T Q M.
void change_rest_shape(const ElementInputs& elements, std::size_t block, const LaneMat3<Real8>& M,
                       const PlasticState& state) {
    const auto first = static_cast<std::size_t>(elements.first[block]);
    LaneVec3<Real8> others{};
    const auto put = [&](std::size_t row, const LaneVec3<Real8>& g) {
        store(g.x, state.gradient[row][0]);
        store(g.y, state.gradient[row][1]);
        store(g.z, state.gradient[row][2]);
    };
    for (std::size_t row = first + 1; row < first + static_cast<std::size_t>(elements.count[block]); ++row) {
        const LaneVec3<Real8> old = load_gradient(state.gradient[row]),
                              g{dot(M.c0, old), dot(M.c1, old), dot(M.c2, old)};
        put(row, g);
        others = others + g;
    }
    put(first, LaneVec3<Real8>{0.0 - others.x, 0.0 - others.y, 0.0 - others.z});
    ElementForm& form = state.mass_form[block];
    const Real8 xy = load(form[3]), yz = load(form[4]), zx = load(form[5]);
    const LaneMat3<Real8> Q{{load(form[0]), xy, zx}, {xy, load(form[1]), yz}, {zx, yz, load(form[2])}},
        QM = multiply(Q, M);
    const Real8 entry[6] = {dot(M.c0, QM.c0), dot(M.c1, QM.c1), dot(M.c2, QM.c2),
                            dot(M.c0, QM.c1), dot(M.c1, QM.c2), dot(M.c2, QM.c0)};
    for (std::size_t i = 0; i < 6; ++i) store(entry[i], form[i]);
}

/// Lets the elements of a block flow: changes their rest shape and plastic strain. Returns the energy that they
/// dissipate [J].
Real yield_block(const ElementInputs& elements, std::size_t block, const MaterialConstants& material,
                 std::span<const Vec3> position, const PlasticState& state) {
    const LaneMat3<Real8> F = deformation_gradient(elements.nodes_of(block), position);
    const Real8 volume = load(elements.volume[block]), before = load(state.plastic_strain[block]);
    Flow flow = flow_of(material, volume, F, before);
    if (!flow.any) return 0;
    if (material.relaxes() && !elements.spring_strain.empty())
        flow.dissipated = flow.dissipated + work_of_springs(elements, block, material, F, multiply(F, flow.inverse));
    change_rest_shape(elements, block, flow.inverse, state);
    store(before + flow.strain, state.plastic_strain[block]);
    Real dissipated = 0;
    for (std::size_t l = 0; l < element_lanes; ++l)
        if (flow.strain[l] > 0) dissipated += volume[l] * flow.dissipated[l];
    return dissipated;
}

}  // namespace

Real yield_elements(Executor& executor, const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                    const PlasticState& state, std::span<Real> parts) {
    const auto count = static_cast<std::size_t>(blocks.size());
    SKERRY_CHECK(parts.size() * blocks_per_yield >= count);
    std::ranges::fill(parts, Real(0));
    parallel_for(executor, count, blocks_per_yield, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            const std::size_t block = static_cast<std::size_t>(blocks.begin) + b;
            const MaterialConstants material = elements.material_of(block);
            if (!material.yields() || !(material.shear_modulus > 0) || elements.is_left_out(block)) continue;
            const Real dissipated = yield_block(elements, block, material, position, state);
            if (!elements.is_of_ghost(block)) parts[b / blocks_per_yield] += dissipated;
        }
    });
    return std::accumulate(parts.begin(), parts.end(), Real(0));
}

void forget_flow(const ElementInputs& elements, Range blocks, std::span<const Vec3> rest_position, const Mat3& rotation,
                 const PlasticState& state) {
    for (auto block = static_cast<std::size_t>(blocks.begin); block < static_cast<std::size_t>(blocks.end); ++block) {
        const Real8 strain = load(state.plastic_strain[block]), zero{}, one = zero + 1.0;
        if (all(strain <= 0.0)) continue;
        // Finds the matrix M that undoes the plastic deformation Fp. With R = `rotation`, plastic flow has changed the
        // rotated rest gradients R g_0 of the mesh to g = Fp^-T R g_0, so M = Fp restores them: M^T g = R g_0. Computed
        // with the gradients g, the rest positions have the deformation gradient A = R^T Fp^-1. So Fp = A^-1 R^T.
        const LaneMat3<Real8> A = deformation_gradient(elements.nodes_of(block), rest_position), cof = cofactor(A);
        const Real8 over_det = 1.0 / (strain > 0.0 ? dot(A.c0, cof.c0) : one);
        LaneMat3<Real8> M;
        LaneVec3<Real8>* const column[3] = {&M.c0, &M.c1, &M.c2};
        for (Index j = 0; j < 3; ++j) {
            const Real x = rotation(j, 0), y = rotation(j, 1), z = rotation(j, 2);
            const LaneVec3<Real8> flow_inverse{over_det * (x * cof.c0.x + y * cof.c0.y + z * cof.c0.z),
                                               over_det * (x * cof.c1.x + y * cof.c1.y + z * cof.c1.z),
                                               over_det * (x * cof.c2.x + y * cof.c2.y + z * cof.c2.z)};
            *column[j] = {strain > 0.0 ? flow_inverse.x : (j == 0 ? one : zero),
                          strain > 0.0 ? flow_inverse.y : (j == 1 ? one : zero),
                          strain > 0.0 ? flow_inverse.z : (j == 2 ? one : zero)};
        }
        change_rest_shape(elements, block, M, state);
        state.plastic_strain[block] = {};
    }
}

}  // namespace skerry
