// Choice of the elements of explicit bodies that are integrated implicitly: the few elements that would otherwise make
// all steps much shorter. The nodes that these elements connect form clusters (docs/methods/clusters.md 5).
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "engine/world/edit/edit_model.h"
#include "engine/world/kernels.h"
#include "engine/world/step/find_twins.h"
#include "engine/world/step/step.h"
#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/clusters/arm_guards.h"
#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/find_implicit_elements.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"

namespace skerry {

namespace {

// Computing time that one entry of a cluster matrix needs in a step [ns]. Only its ratio to element_cost matters: 0.01.
// Measured ratios are 0.005 to 0.02, for clusters of 48 to 594 nodes in meshes of 10,368 and 48,000 tetrahedra.
constexpr Real entry_cost = 0.7;
/// Clusters must reduce the computing time of a simulated second at least by this factor. A smaller gain does not
/// justify the slight change of the results.
constexpr Real least_gain = 1.5;
/// Limits of the moment of inertia that clusters may add to a body: the larger of share_of_moment times its smallest
/// principal moment I, and share_of_lumping times the amount by which lumping of the masses increases I. In typical
/// meshes this is 3 to 20 % of I.
constexpr Real share_of_moment = 0.01, share_of_lumping = 0.25;
// Largest number of nodes in a cluster. The matrix of such a cluster takes 8 MB, and about a second to invert.
constexpr std::size_t largest_cluster = 1024;
/// Assumed stiffness of the elements of clusters, divided by their stiffness at rest. Cluster matrices are computed
/// with this stiffness, so that steps stay stable while strain stiffens the elements.
constexpr Real stiffness_ratio = 4;
/// A step length is rejected if more than the fraction most_volume_of_large of a body with more than nodes_of_large
/// nodes would be implicit. The implicit elements would then probably form a cluster larger than largest_cluster. This
/// test is faster than the search for implicit elements.
constexpr Index nodes_of_large = 8 * static_cast<Index>(largest_cluster);
constexpr Real most_volume_of_large = 0.25;
// Upper limit of the ratio of the stable step with clusters to the stable step without clusters.
constexpr Real most_lengthening = 32;
/// Lower limit of the ratio of the stable step with clusters to that without. With a smaller ratio the computing time
/// could hardly fall by the factor least_gain.
constexpr Real least_lengthening = 1.68;
/// Assumed ratio of the stable step with mass forms to that with mass shares (docs/methods/stable_step.md 2), for
/// explicit elements. Measured: 1.27 to 1.34 for four meshes. It is needed because the search for implicit elements
/// uses mass shares, but the simulation mass forms.
constexpr Real gain_of_forms = 1.25;

bool has_elements(const Model& model, std::size_t b) {
    return model.bodies.blocks[b].size() > 0;
}

/// True if a body must not have clusters, for one of two reasons:
/// - One of its materials yields. Plastic flow changes the stiffness from which cluster matrices are computed.
/// - Nodes are held along single directions (hold_axes). The impulses that hold them are computed from the masses of
///   single nodes, not from the inertia of clusters.
bool forbids_clusters(const Model& model, std::size_t b) {
    if (model.yields(b)) return true;
    for (std::size_t a = 0; a < model.attachments.slot.size(); ++a)
        if (model.attachments.body[a] == static_cast<Index>(b) && !holds_completely(model.attachments.held[a]))
            return true;
    return false;
}

Real step_of(const Model& model, std::size_t b, std::span<const Vec3> position, std::span<Real> stiffness_sum) {
    return kernels()
        .stable_step(model.all_elements(), model.bodies.blocks[b], position, model.nodes.mass, stiffness_sum)
        .step;
}

/// Copy of the element columns of a body that depend on which elements are implicit. restore() writes them back.
struct SavedElements {
    std::vector<ElementLane> mass_share, modulus;
    std::vector<ElementForm> mass_form;
    std::vector<FrameMass> frame_mass;
    std::vector<Real> frame_bound;
    SavedElements(Model& model, std::size_t b) {
        const auto save_rows = [&](auto& column, auto& saved_rows) {
            const auto rows = rows_of(column, model.bodies.blocks[b]);
            saved_rows.assign(rows.begin(), rows.end());
        };
        save_rows(model.elements.mass_share, mass_share);
        save_rows(model.elements.implicit_modulus, modulus);
        save_rows(model.elements.mass_form, mass_form);
        save_rows(model.elements.frame_mass, frame_mass);
        save_rows(model.elements.frame_bound, frame_bound);
    }
    void restore(Model& model, std::size_t b) const {
        const Range blocks = model.bodies.blocks[b];
        std::ranges::copy(mass_share, rows_of(model.elements.mass_share, blocks).begin());
        std::ranges::copy(modulus, rows_of(model.elements.implicit_modulus, blocks).begin());
        std::ranges::copy(mass_form, rows_of(model.elements.mass_form, blocks).begin());
        std::ranges::copy(frame_mass, rows_of(model.elements.frame_mass, blocks).begin());
        std::ranges::copy(frame_bound, rows_of(model.elements.frame_bound, blocks).begin());
    }
};

/// Updates all data of a body that depend on which of its elements are implicit: inversion barriers, viscosity, and the
/// factor tetrahedra.leeway on the allowed change of strain.
void note_implicit(Model& model, std::size_t b) {
    const Range of_body = model.bodies.blocks[b];
    arm_guards(model.all_elements(), of_body, model.nodes.inverse_mass,
               {rows_of(model.elements.implicit_modulus, of_body), rows_of(model.elements.volume, of_body)});
    find_leeway(model.body_records[b].element_tetrahedra,
                rows_of(model.elements.implicit_modulus, model.bodies.blocks[b]), implicit_leeway,
                rows_of(model.tetrahedra.leeway, model.bodies.tetrahedron_blocks[b]));
    const Range blocks = model.bodies.blocks[b];
    const std::span<Real> time = rows_of(model.elements.viscous_time, blocks);
    find_viscous_times(rows_of(model.elements.implicit_modulus, blocks), model.bodies.cluster_step[b], time);
    model.patches.resize_viscous(model.elements.first.size());
}

/// Upper bound of the moment of inertia that clusters may add to a body, as a fraction of its smallest principal
/// moment.
Real largest_moment_of(const Model& model, std::size_t b) {
    const Range blocks = model.bodies.tetrahedron_blocks[b];
    return std::max(share_of_moment, share_of_lumping * moment_of_lumping(rows_of(model.tetrahedra.node, blocks),
                                                                          rows_of(model.tetrahedra.volume, blocks),
                                                                          model.nodes.rest_position));
}

struct Assessment {
    bool possible = false;  // false if too many elements would be implicit, or clusters would be too large or too heavy
    Real moment = 0;        // moment of inertia that clusters add, divided by the largest allowed value
    ClusterSizes sizes{};
};

Assessment assess(const Model& model, std::size_t b, const ImplicitShare& share, Real largest_moment) {
    if (share.too_many || !(share.moment <= largest_moment)) return {};
    const Range blocks = model.bodies.blocks[b];
    const ClusterSizes sizes = cluster_sizes(
        model.all_elements(), blocks, rows_of(model.elements.implicit_modulus, blocks), model.nodes.inverse_mass);
    if (sizes.largest > largest_cluster) return {};
    return {true, share.moment / largest_moment, sizes};
}

ImplicitOutputs outputs_of(Model& model, Range blocks) {
    return {rows_of(model.elements.mass_share, blocks), rows_of(model.elements.implicit_modulus, blocks)};
}

/// Finds the implicit elements of bodies at rest for trial step lengths. Equal bodies share one search.
class Searches {
public:
    Searches(Model& model, std::span<Real> stiffness_sum)
        : model_(model), stiffness_sum_(stiffness_sum), twin_(find_twins(model)), groups_(twin_.size()) {
        for (const std::size_t first : twin_) ++groups_[first].bodies;
    }

    /// True if a body is large (nodes_of_large) and too much of its volume would be implicit at the step length `step`
    /// [s].
    bool too_much_volume(std::size_t b, Real step) {
        TwinGroup& twins = groups_[twin_[b]];
        if (!(model_.bodies.nodes[b].size() > nodes_of_large) || stored_result(twins, step)) return false;
        start(b, twins);
        return twins.search->estimate_volume(step / gain_of_forms) > most_volume_of_large;
    }

    /// Finds the implicit elements of a body for the step length `step` [s], and writes the element columns of the
    /// body. If Assessment::possible is false, the written values are invalid and the caller must restore the columns.
    Assessment find(std::size_t b, Real step) {
        TwinGroup& twins = groups_[twin_[b]];
        if (const Result* stored = stored_result(twins, step)) {
            stored->elements.restore(model_, b);
            return stored->found;
        }
        start(b, twins);
        const SavedElements saved(model_, twins.searched);
        const ImplicitShare share =
            twins.search->find({step, step / gain_of_forms, stiffness_ratio, twins.largest_moment, largest_cluster,
                                model_.nodes.inverse_mass});
        const Assessment found = assess(model_, twins.searched, share, twins.largest_moment);
        Result result{step, found, SavedElements(model_, twins.searched)};
        saved.restore(model_, twins.searched);
        result.elements.restore(model_, b);
        if (twins.bodies > 1) twins.results.push_back(std::move(result));
        return found;
    }

private:
    struct Result {
        Real step;  // s
        Assessment found;
        SavedElements elements;
    };
    struct TwinGroup {
        std::size_t bodies = 0, searched = 0;
        Real largest_moment = 0;                 // see largest_moment_of
        std::optional<ImplicitSearch> search{};  // created when it is first used
        std::vector<Result> results{};
    };
    static const Result* stored_result(const TwinGroup& twins, Real step) {
        const auto found = std::ranges::find(twins.results, step, &Result::step);
        return found == twins.results.end() ? nullptr : &*found;
    }
    /// Creates the search for implicit elements that a group of equal bodies shares, from the data of body `b`, unless
    /// the group already has one.
    void start(std::size_t b, TwinGroup& twins) {
        if (twins.search) return;
        const Range blocks = model_.bodies.blocks[b];
        twins.search.emplace(model_.all_elements(), blocks, model_.nodes.rest_position, model_.nodes.mass,
                             stiffness_sum_, outputs_of(model_, blocks), kernels().element_bounds);
        twins.searched = b;
        twins.largest_moment = largest_moment_of(model_, b);
    }
    Model& model_;
    std::span<Real> stiffness_sum_;
    std::vector<std::size_t> twin_;
    std::vector<TwinGroup> groups_;  // the entry of a group of equal bodies is at the row of its first body
};

/// Makes all elements of a body explicit again, and computes mass shares, mass forms and stable steps as for a new
/// body.
void make_explicit(Model& model, std::size_t b, std::span<Real> stiffness_sum) {
    const Range blocks = model.bodies.blocks[b];
    const std::span<ElementLane> share = rows_of(model.elements.mass_share, blocks);
    start_mass_shares(model.all_elements(), blocks, share);
    std::ranges::fill(rows_of(model.elements.implicit_modulus, blocks), ElementLane{});
    model.bodies.cluster_step[b] = 0;
    note_implicit(model, b);
    kernels().find_mass_shares(model.all_elements(), blocks, model.nodes.rest_position, model.nodes.mass, stiffness_sum,
                               share);
    choose_mass_forms(model, static_cast<Index>(b), stiffness_sum);
    model.bodies.rest_step[b] = step_of(model, b, model.nodes.rest_position, stiffness_sum);
    model.bodies.stable_step[b] = step_of(model, b, model.nodes.position, stiffness_sum);
}

/// Computing time of a simulated second [ns], with steps of length `step` [s]. `entries`: number of entries of all
/// cluster matrices.
Real cost_of(const Model& model, std::size_t entries, Real step) {
    const std::uint64_t blocks = std::max<std::uint64_t>(model.elements.first.size(), model.of_ranks.element_blocks);
    const Real elements = static_cast<Real>(blocks * element_lanes);
    return (element_cost * elements + entry_cost * static_cast<Real>(entries)) / step;
}

struct PlannedBody {
    std::size_t row;
    Real moment;             // moment of inertia that clusters add, divided by the largest allowed value
    SavedElements elements;  // element columns of the body after the planned change
};

/// A choice of implicit elements in all bodies, for one step length.
struct Plan {
    Real step = 0;  // step length for which the plan is made; 0: every element is explicit [s]
    Real cost = 0;  // computing time of a simulated second [ns]
    bool possible = true;
    std::size_t entries = 0;
    std::vector<PlannedBody> body;  // entries for the bodies that get implicit elements
};

Plan plan_for(Model& model, Real step, Searches& searches) {
    Plan plan{.step = step, .body = {}};
    for (std::size_t b = 0; b < model.bodies.slot.size() && plan.possible; ++b) {
        if (!has_elements(model, b) || model.bodies.rest_step[b] >= step) continue;
        if (forbids_clusters(model, b) || searches.too_much_volume(b, step)) {
            plan.possible = false;
            break;
        }
        const SavedElements saved(model, b);
        const Assessment found = searches.find(b, step);
        plan.possible = found.possible;
        plan.entries += found.sizes.entries;
        plan.body.push_back({b, found.moment, SavedElements(model, b)});
        saved.restore(model, b);
    }
    plan.cost = cost_of(model, plan.entries, step);
    return plan;
}

/// Makes the planned elements of a body implicit, and chooses mass forms for the other elements. Returns the stable
/// step of the explicit elements [s].
Real make_planned_implicit(Model& model, const PlannedBody& planned, std::span<Real> stiffness_sum) {
    planned.elements.restore(model, planned.row);
    choose_mass_forms(model, static_cast<Index>(planned.row), stiffness_sum);
    return step_of(model, planned.row, model.nodes.rest_position, stiffness_sum);
}

/// Stores that the clusters of a body are made for the step length `step` [s]. `stable`: stable step of the explicit
/// elements of the body [s].
void set_cluster_step(Model& model, std::size_t b, Real step, Real stable) {
    model.bodies.cluster_step[b] = step;
    note_implicit(model, b);
    model.bodies.rest_step[b] = std::min(step, stable);
}

/// Longest step for which the planned clusters are not too heavy [s]. The inertia that they add grows with the square
/// of the step length. `step`: planned step length [s]. `moment`: moment of inertia that they add at this length,
/// divided by the largest allowed value.
Real longest_by_moment(Real step, Real moment) {
    return moment > 0 ? step / std::sqrt(moment) : infinity;
}

Real longest_step(const Model& model) {
    return model.settings.step_size.value_or(infinity) / model.tuning.step_safety;
}

/// Makes the planned elements of all bodies implicit. The clusters are made for the longest step that three limits
/// allow: the settings, the stable steps of explicit elements (with mass forms), and the moment of inertia that
/// clusters may add.
void make_planned_implicit(Model& model, const Plan& plan, std::span<Real> stiffness_sum) {
    const std::vector<std::size_t> twin = find_twins(model);
    Real step = longest_step(model);
    // for each body: stable step of its explicit elements; 0: the plan has no clusters for it [s]
    std::vector<Real> stable(twin.size());
    for (const PlannedBody& body : plan.body) {
        // Equal bodies have equal plans. So mass forms are computed for the first of them, and copied to the others.
        if (const std::size_t first = twin[body.row]; stable[first] > 0) {
            body.elements.restore(model, body.row);
            const auto copy_from_first = [&](auto& column) {
                std::ranges::copy(rows_of(column, model.bodies.blocks[first]),
                                  rows_of(column, model.bodies.blocks[body.row]).begin());
            };
            copy_from_first(model.elements.mass_form);
            copy_from_first(model.elements.frame_mass);
            copy_from_first(model.elements.frame_bound);
            stable[body.row] = stable[first];
        } else {
            stable[body.row] = make_planned_implicit(model, body, stiffness_sum);
        }
        step = std::min({step, stable[body.row], longest_by_moment(plan.step, body.moment)});
    }
    for (std::size_t b = 0; b < stable.size(); ++b)
        if (has_elements(model, b) && !(stable[b] > 0)) step = std::min(step, model.bodies.rest_step[b]);
    for (const PlannedBody& body : plan.body) set_cluster_step(model, body.row, step, stable[body.row]);
}

/// Shortest stable step at rest among all bodies with elements [s].
Real shortest_step(const Model& model) {
    Real shortest = infinity;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (has_elements(model, b)) shortest = std::min(shortest, model.bodies.rest_step[b]);
    return shortest;
}

/// Returns the plan with the least computing time among the plans for the following step lengths. s is the shortest
/// stable step.
/// - 2 s, 4 s, 8 s ...
/// - least_lengthening * s, if none of these gains enough
/// - lengths between the best one so far and twice the best one
/// If no plan reduces the computing time by the factor least_gain, returns a plan with step 0.
Plan choose_plan(Model& model, std::span<Real> stiffness_sum) {
    const Real shortest = shortest_step(model), longest = longest_step(model);
    Plan best{.body = {}};
    if (!(shortest > 0) || !std::isfinite(shortest)) return best;
    best.cost = cost_of(model, 0, std::min(shortest, longest)) / least_gain;
    Searches searches(model, stiffness_sum);
    const auto try_step = [&](Real step) {
        Plan plan = plan_for(model, step, searches);
        const bool possible = plan.possible;
        if (possible && plan.cost <= best.cost) best = std::move(plan);
        return possible;
    };
    for (Real step = 2 * shortest; step <= most_lengthening * shortest; step *= 2) {
        if (!try_step(std::min(step, longest)) || !(step < longest)) break;
    }
    if (!(best.step > 0) && least_lengthening * shortest < longest) try_step(least_lengthening * shortest);
    if (!(best.step > least_lengthening * shortest)) return best;
    for (Real ratio = std::sqrt(Real(2)); ratio > 1.15; ratio = std::sqrt(ratio)) {
        const Real between = best.step * ratio;
        if (between < longest && between < most_lengthening * shortest) try_step(between);
    }
    return best;
}

}  // namespace

bool clusters_allowed(const Settings& settings) {
    return settings.clusters;
}

bool make_implicit(Model& model, std::size_t body, Real step, Real present_step, std::span<Real> stiffness_sum) {
    if (forbids_clusters(model, body)) return false;
    // computing time of the inversion of a matrix, divided by the cube of its number of rows [ns]
    constexpr Real inversion_cost = 0.4;
    constexpr Real steps_per_inversion = 128;  // assumed number of steps between two inversions of a cluster matrix
    const Range blocks = model.bodies.blocks[body];
    const SavedElements saved(model, body);
    const std::size_t entries = std::max<std::size_t>(model.clusters.inverse.size(), model.of_ranks.cluster_entries);
    const std::size_t body_entries =
        cluster_sizes(model.all_elements(), blocks, saved.modulus, model.nodes.inverse_mass).entries;
    const Real cluster_step = std::max(step, model.bodies.cluster_step[body]);
    // Mass forms are removed, because the search for implicit elements evaluates stable steps with mass shares. Mass
    // shares adapt to the deformed shape, whereas mass forms are the same in every shape.
    forget_mass_forms(model, blocks);
    const Real largest_moment = largest_moment_of(model, body);
    const Assessment found =
        assess(model, body,
               add_implicit_elements(model.all_elements(), blocks, model.nodes.position, model.nodes.mass,
                                     {cluster_step, step, stiffness_ratio, largest_moment}, stiffness_sum,
                                     outputs_of(model, blocks), kernels().element_bounds),
               largest_moment);
    const Real inversions = inversion_cost * static_cast<Real>(found.sizes.cubes) / (steps_per_inversion * step);
    if (found.possible && cost_of(model, entries - body_entries + found.sizes.entries, step) + inversions <
                              cost_of(model, entries, present_step)) {
        model.bodies.cluster_step[body] = cluster_step;
        note_implicit(model, body);
        return true;
    }
    saved.restore(model, body);
    return false;
}

void settle_clusters(Model& model, Column<Real>& stiffness_sum) {
    if (!model.clusters_open) return;
    model.clusters_open = false;
    if (!clusters_allowed(model.settings)) return;
    stiffness_sum.resize(model.nodes.position.size());
    const std::span<Real> sums = stiffness_sum.span();
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b)
        if (model.bodies.cluster_step[b] > 0) make_explicit(model, b, sums);
    const Plan plan = choose_plan(model, sums);
    if (plan.step > 0) make_planned_implicit(model, plan, sums);
    model.rebuild_clusters();
    evaluate_stable_steps(model, stiffness_sum);
}

Real added_energy(const Model& model) {
    if (model.clusters.empty()) return 0;
    Real energy = 0;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        if (!(model.bodies.cluster_step[b] > 0) || model.bodies.is_ghost(b)) continue;
        const Range blocks = model.bodies.blocks[b];
        energy += added_energy(model.all_elements(), blocks,
                               model.elements.implicit_modulus.span().subspan(static_cast<std::size_t>(blocks.begin),
                                                                              static_cast<std::size_t>(blocks.size())),
                               model.bodies.cluster_step[b], model.nodes.velocity);
    }
    return energy;
}

}  // namespace skerry
