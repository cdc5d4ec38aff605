// Which elements are implicit: those that would make the steps of all much shorter (docs/methods/clusters.md 5).
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/world/step/step.h"
#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

// ns, of a step: an element with its part of nodes and contacts, and an entry of a cluster's matrix. On two machines;
// only their ratio matters.
constexpr Real element_cost = 70, entry_cost = 0.7;
/// What it has to save of the cost of a simulated second, for results that differ a little.
constexpr Real least_gain = 1.5;
/// The least moment of inertia of a body may grow by this part.
constexpr Real most_moment = 0.01;
constexpr std::size_t largest_cluster = 1024;  // nodes: 8 MB, a second to invert
/// Implicit elements are taken to be so much stiffer than they are, so that they may deform for a while.
constexpr Real headroom = 4;
/// In how many times max_strain_step tetrahedra may deform that an implicit element covers.
constexpr Real leeway = 5;
constexpr int candidates = 8;  // each sqrt(2) times as long as the one before

template <class T>
std::span<T> rows_of(Column<T>& column, Range rows) {
    return column.span().subspan(static_cast<std::size_t>(rows.begin), static_cast<std::size_t>(rows.size()));
}

bool has_elements(const Model& model, std::size_t b) {
    return model.bodies.tetrahedron_count[b] > 0;
}

Real step_of(const Model& model, std::size_t b, std::span<const Vec3> position, std::span<Real> stiffness_sum) {
    return stable_step(model.all_elements(), model.bodies.blocks[b], position, model.nodes.mass, stiffness_sum).step;
}

/// Shares and moduli of a body, to be put back.
struct Kept {
    std::vector<ElementLane> mass_share, modulus;
    Kept(Model& model, std::size_t b) {
        const std::span<ElementLane> share = rows_of(model.elements.mass_share, model.bodies.blocks[b]);
        const std::span<ElementLane> of = rows_of(model.elements.implicit_modulus, model.bodies.blocks[b]);
        mass_share.assign(share.begin(), share.end());
        modulus.assign(of.begin(), of.end());
    }
    void put_back(Model& model, std::size_t b) const {
        std::ranges::copy(mass_share, rows_of(model.elements.mass_share, model.bodies.blocks[b]).begin());
        std::ranges::copy(modulus, rows_of(model.elements.implicit_modulus, model.bodies.blocks[b]).begin());
    }
};

/// Which tetrahedra of a body implicit elements cover.
void note_leeway(Model& model, std::size_t b) {
    const std::span<ElementLane> of = rows_of(model.tetrahedra.leeway, model.bodies.tetrahedron_blocks[b]);
    const ElementLane one{{1, 1, 1, 1, 1, 1, 1, 1}};
    std::ranges::fill(of, one);
    const std::span<const ElementLane> modulus = rows_of(model.elements.implicit_modulus, model.bodies.blocks[b]);
    const Ragged<Index>& covered = model.body_records[b].element_tetrahedra;
    for (std::size_t place = 0; place < covered.size(); ++place)
        if (modulus[place / element_lanes][place % element_lanes] > 0)
            for (const Index t : covered[place]) {
                const auto at = static_cast<std::size_t>(t);
                of[at / element_lanes][at % element_lanes] = leeway;
            }
}

/// Finds the implicit elements of a body for a step; no_index entries where there are too many.
struct Found {
    bool possible = false;
    std::size_t entries = 0;
};
Found find(Model& model, std::size_t b, Real step, std::span<const Vec3> position, std::span<Real> stiffness_sum) {
    const Range blocks = model.bodies.blocks[b];
    const std::span<ElementLane> modulus = rows_of(model.elements.implicit_modulus, blocks);
    const ImplicitShare share =
        find_implicit_elements(model.all_elements(), blocks, position, model.nodes.mass, step, headroom, stiffness_sum,
                               {rows_of(model.elements.mass_share, blocks), modulus});
    if (share.too_many || !(share.moment <= most_moment)) return {};
    const ClusterSizes sizes = cluster_sizes(model.all_elements(), blocks, modulus, model.nodes.inverse_mass);
    if (sizes.largest > largest_cluster) return {};
    return {true, sizes.entries};
}

/// Every element explicit again, with the masses shared as for a new body.
void make_explicit(Model& model, std::size_t b, std::span<Real> stiffness_sum) {
    const Range blocks = model.bodies.blocks[b];
    const std::span<ElementLane> share = rows_of(model.elements.mass_share, blocks);
    start_mass_shares(model.all_elements(), blocks, share);
    std::ranges::fill(rows_of(model.elements.implicit_modulus, blocks), ElementLane{});
    model.bodies.cluster_step[b] = 0;
    note_leeway(model, b);
    find_mass_shares(model.all_elements(), blocks, model.nodes.rest_position, model.nodes.mass, stiffness_sum, share);
    model.bodies.rest_step[b] = step_of(model, b, model.nodes.rest_position, stiffness_sum);
    model.bodies.stable_step[b] = step_of(model, b, model.nodes.position, stiffness_sum);
}

/// ns a second, where steps are `step` long.
Real cost_of(const Model& model, std::size_t entries, Real step) {
    const Real elements = static_cast<Real>(model.elements.first.size() * element_lanes);
    return (element_cost * elements + entry_cost * static_cast<Real>(entries)) / step;
}

/// The entries of the clusters that all bodies would need for a step; possible: none would be too large.
Found try_step_length(Model& model, Real step, std::span<Real> stiffness_sum) {
    Found all{.possible = true};
    for (std::size_t b = 0; b < model.bodies.slot.size() && all.possible; ++b) {
        if (!has_elements(model, b) || model.bodies.rest_step[b] >= step) continue;
        const Kept kept(model, b);
        const Found found = find(model, b, step, model.nodes.rest_position, stiffness_sum);
        kept.put_back(model, b);
        all.possible = found.possible;
        all.entries += found.entries;
    }
    return all;
}

/// s, the step worth having clusters for; 0: none.
Real choose_step(Model& model, std::span<Real> stiffness_sum) {
    Real shortest = std::numeric_limits<Real>::infinity();
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (has_elements(model, b)) shortest = std::min(shortest, model.bodies.rest_step[b]);
    const Real longest =
        model.settings.step_size.value_or(std::numeric_limits<Real>::infinity()) / model.settings.step_safety;
    if (!(shortest > 0) || !std::isfinite(shortest)) return 0;
    Real best = 0, least = cost_of(model, 0, std::min(shortest, longest)) / least_gain;
    int impossible = 0;  // lengths in a row
    for (int k = 1; k <= candidates; ++k) {
        const Real step = std::min(shortest * std::exp2(k / 2.0), longest);
        if (!(step > shortest)) break;
        const Found found = try_step_length(model, step, stiffness_sum);
        impossible = found.possible ? 0 : impossible + 1;
        if (impossible == 2) break;  // a longer one can need fewer elements, but hardly ever twice
        if (!found.possible) continue;
        if (const Real cost = cost_of(model, found.entries, step); cost <= least) {
            least = cost;
            best = step;
        }
        if (found.entries == 0 || step == longest)
            break;  // nothing stands in the way of longer ones: not ours to choose
    }
    return best;
}

}  // namespace

bool clusters_allowed(const Settings& settings) {
    return settings.clusters && !settings.multirate && settings.integrator != Integrator::forward_euler &&
           settings.contact_regions != ContactRegions::paper_algorithm_1;
}

bool make_implicit(Model& model, std::size_t body, Real step, std::span<const Vec3> position,
                   std::span<Real> stiffness_sum) {
    const Kept kept(model, body);
    if (!find(model, body, step, position, stiffness_sum).possible) {
        kept.put_back(model, body);
        return false;
    }
    model.bodies.cluster_step[body] = step;
    note_leeway(model, body);
    return true;
}

void settle_clusters(Model& model, Column<Real>& stiffness_sum) {
    if (!model.clusters_open) return;
    model.clusters_open = false;
    if (!clusters_allowed(model.settings)) return;
    stiffness_sum.resize(model.nodes.position.size());
    const std::span<Real> sums = stiffness_sum.span();
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.cluster_step[b] > 0) make_explicit(model, b, sums);
    const Real step = choose_step(model, sums);
    if (step > 0)
        for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
            if (has_elements(model, b) && model.bodies.rest_step[b] < step &&
                make_implicit(model, b, step, model.nodes.rest_position, sums))
                model.bodies.rest_step[b] = std::min(step, step_of(model, b, model.nodes.rest_position, sums));
    model.rebuild_clusters();
    watch_stable_steps(model, stiffness_sum);
}

Real added_energy(const Model& model) {
    if (model.clusters.empty()) return 0;
    Real energy = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (!(model.bodies.cluster_step[b] > 0)) continue;
        const Range blocks = model.bodies.blocks[b];
        energy += added_energy(model.all_elements(), blocks,
                               model.elements.implicit_modulus.span().subspan(static_cast<std::size_t>(blocks.begin),
                                                                              static_cast<std::size_t>(blocks.size())),
                               model.bodies.cluster_step[b], model.nodes.velocity);
    }
    return energy;
}

}  // namespace skerry
