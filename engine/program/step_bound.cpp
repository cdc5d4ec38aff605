#include "engine/program/step_bound.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "engine/mesh/tetrahedron.h"
#include "engine/scene/scene_plan.h"
#include "engine/world/step/step.h"
#include "engine/world/world_state.h"

namespace skerry {

namespace {

constexpr std::size_t listed_count = 3;
constexpr Real fractions[] = {0.001, 0.01};

Real altitude_of(const Mesh& mesh, Index tetrahedron) {
    const std::array<Index, 4>& corners = mesh.tetrahedra[static_cast<std::size_t>(tetrahedron)];
    return mesh::six_volumes(mesh, corners) / std::sqrt(mesh::largest_face_squared(mesh, corners));
}

CostlyTetrahedron describe(const Mesh& mesh, Index tetrahedron, Real step) {
    const std::array<Index, 4>& corners = mesh.tetrahedra[static_cast<std::size_t>(tetrahedron)];
    CostlyTetrahedron found{tetrahedron, Vec3::Zero(), altitude_of(mesh, tetrahedron), 0, step};
    for (const Index n : corners) found.place += mesh.nodes[static_cast<std::size_t>(n)] / 4;
    for (const Real edge : mesh::edge_lengths(mesh, corners)) found.mean_edge += edge / 6;
    return found;
}

/// Sorts all tetrahedra by the step that they allow, smallest first. Tetrahedra whose steps exceed the smallest one by
/// less than 10 % are sorted by altitude instead.
std::vector<Index> worst_first(const Mesh& mesh, std::span<const Real> step) {
    constexpr Real about = 1.1;
    // A badly shaped tetrahedron also shortens the steps of its neighbours, because they share nodal masses. Only by
    // its small altitude can it be told from them.
    const Real least = about * *std::min_element(step.begin(), step.end());
    std::vector<std::pair<Real, Real>> key(step.size());
    for (std::size_t t = 0; t < key.size(); ++t)
        key[t] = {std::max(step[t], least), altitude_of(mesh, static_cast<Index>(t))};
    std::vector<Index> order(step.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
        return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
    });
    return order;
}

/// Returns a copy of the mesh without the tetrahedra `removed`, and without the nodes that no remaining tetrahedron
/// uses.
Mesh without_tetrahedra(const Mesh& mesh, std::span<const Index> removed) {
    std::vector<bool> stays(mesh.tetrahedra.size(), true);
    for (const Index t : removed) stays[static_cast<std::size_t>(t)] = false;
    Mesh remaining;
    std::vector<Index> row(mesh.nodes.size(), no_index);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (!stays[t]) continue;
        std::array<Index, 4> corners = mesh.tetrahedra[t];
        for (Index& n : corners) {
            Index& new_row = row[static_cast<std::size_t>(n)];
            if (new_row == no_index) {
                new_row = static_cast<Index>(remaining.nodes.size());
                remaining.nodes.push_back(mesh.nodes[static_cast<std::size_t>(n)]);
            }
            n = new_row;
        }
        remaining.tetrahedra.push_back(corners);
        if (!mesh.label.empty()) remaining.label.push_back(mesh.label[t]);
    }
    return remaining;
}

// Number of tetrahedra above which a mesh counts as large. It takes seconds to build another world with such a mesh.
constexpr std::size_t many = 100'000;

/// Considers the `count` tetrahedra that allow the shortest steps. Returns the longest of these steps, divided by the
/// shortest.
Real ratio_within_worst(std::span<const Real> step, std::size_t count) {
    std::vector<Real> sorted(step.begin(), step.end());
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(count - 1);
    std::nth_element(sorted.begin(), last, sorted.end());
    return *last / *std::min_element(sorted.begin(), last + 1);
}

/// For each fraction in `fractions`, removes this fraction of the tetrahedra, the worst ones, and adds the stable step
/// of the remaining mesh to bound.without.
/// - `step`: step that each tetrahedron allows [s].
/// - `order`: result of worst_first().
void find_steps_without(const Mesh& mesh, const BodyCase& body_case, std::span<const Real> step,
                        std::vector<Index> order, StepBound& bound) {
    // In a large mesh, a fraction of the tetrahedra is skipped if the longest step that they allow is less than this
    // multiple of the shortest one. Their removal would then gain little.
    constexpr Real least_ratio = 1.5;
    const bool large = mesh.tetrahedra.size() > many;
    // Number of rounds in which a fraction is removed. Each round changes the nodal masses, and so the ranking of the
    // remaining tetrahedra. A large mesh takes seconds per round.
    const std::size_t rounds = large ? 1 : 3;
    Mesh remaining = mesh;
    std::size_t removed = 0;
    for (const Real fraction : fractions) {
        const auto count = static_cast<std::size_t>(std::ceil(fraction * static_cast<Real>(mesh.tetrahedra.size())));
        if (count >= mesh.tetrahedra.size() || count == removed) continue;
        if (large) {
            const Real ratio = ratio_within_worst(step, count);
            if (ratio < least_ratio) {
                bound.alike_share = fraction;
                bound.alike_ratio = ratio;
                continue;
            }
        }
        const std::size_t at_once = (count - removed + rounds - 1) / rounds;
        Real longer = 0;
        while (removed < count) {
            const std::size_t removed_now = std::min(at_once, count - removed);
            remaining = without_tetrahedra(remaining, std::span(order).first(removed_now));
            removed += removed_now;
            const ExplicitBody body = explicit_body(remaining, body_case);
            longer = body.world.stable_step();
            order = worst_first(remaining, body.world.tetrahedron_steps(body.handle));
        }
        bound.without.push_back({fraction, count, longer});
    }
}

void add_details(const Mesh& mesh, const BodyCase& body_case, std::span<const Real> step, StepBound& bound) {
    const std::vector<Index> order = worst_first(mesh, step);
    const auto least = static_cast<Index>(std::min_element(step.begin(), step.end()) - step.begin());
    bound.worst.push_back(describe(mesh, least, step[static_cast<std::size_t>(least)]));
    for (const Index t : order) {
        if (bound.worst.size() == listed_count) break;
        if (t != least) bound.worst.push_back(describe(mesh, t, step[static_cast<std::size_t>(t)]));
    }
    find_steps_without(mesh, body_case, step, order, bound);
}

}  // namespace

BodyCase body_case_of(const ScenePlan& plan, const BodyPlan& body) {
    BodyCase body_case{.settings = plan.settings,
                       .material = plan.materials[body.material].second,
                       .body = body.settings,
                       .labelled = {}};
    for (const auto& [label, material] : body.materials)
        body_case.labelled.emplace(label, plan.materials[material].second);
    return body_case;
}

StepBound step_bound(const Mesh& mesh, const BodyCase& body_case, bool details) {
    const ExplicitBody body = explicit_body(mesh, body_case);
    StepBound bound{
        .step = body.world.stable_step(), .element = body.world.element(body.handle), .worst = {}, .without = {}};
    if (details) add_details(mesh, body_case, body.world.tetrahedron_steps(body.handle), bound);
    return bound;
}

StepBound step_bound(World& world, BodyHandle body, const Mesh& mesh, const BodyCase& body_case) {
    const Model& model = WorldAccess::state_of(world).model;
    StepBound bound{.step = step_of_body(model, static_cast<std::size_t>(model.row(body, "step_bound"))),
                    .element = world.element(body),
                    .worst = {},
                    .without = {}};
    add_details(mesh, body_case, world.tetrahedron_steps(body), bound);
    return bound;
}

}  // namespace skerry
