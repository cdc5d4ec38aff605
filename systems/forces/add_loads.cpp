#include "systems/forces/add_loads.h"

#include <algorithm>

#include "jobs/parallel_for.h"

namespace skerry {

namespace {

constexpr std::size_t loaded_nodes_per_block = 4096;

/// Calls visit(n) for each row of a range of NodeTable. Parallel over nodes.
void for_nodes(Executor& executor, Range nodes, auto&& visit) {
    const auto first = static_cast<std::size_t>(nodes.begin);
    parallel_for(executor, static_cast<std::size_t>(nodes.size()), loaded_nodes_per_block,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t n = first + begin; n < first + end; ++n) visit(n);
                 });
}

/// Calls visit(body) for each body that a field acts on.
void for_bodies_of_field(const LoadInputs& loads, std::size_t load, auto&& visit) {
    for (std::size_t body = 0; body < loads.body_kind.size(); ++body)
        if (loads.acts_on(load, body)) visit(body);
}

/// Adds the same acceleration [m/s^2] to all nodes of a body.
void accelerate(Executor& executor, const LoadInputs& loads, std::size_t body, const Vec3& acceleration,
                std::span<Vec3> force) {
    if (acceleration == Vec3::Zero()) return;
    for_nodes(executor, loads.body_nodes[body], [&](std::size_t n) { force[n] += loads.mass[n] * acceleration; });
}

void add_to_nodes(Executor& executor, const LoadInputs& loads, std::size_t load, std::span<Vec3> force) {
    const auto body = static_cast<std::size_t>(loads.load_body[load]);
    const std::span<const Index> nodes = rows_of(loads.share_node, loads.load_nodes[load]);
    const std::span<const Real> weight = rows_of(loads.weight, loads.load_nodes[load]);
    const Vec3 whole = loads.scale(load, body) * loads.vector[load];
    if (whole == Vec3::Zero()) return;
    const auto first = static_cast<std::size_t>(loads.body_nodes[body].begin);
    parallel_for(executor, nodes.size(), loaded_nodes_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) force[first + static_cast<std::size_t>(nodes[i])] += weight[i] * whole;
    });
}

}  // namespace

bool LoadInputs::acts_on(std::size_t load, std::size_t body) const {
    if (body_kind[body] != BodyKind::deformable) return false;
    if (load_body[load] != no_index) return load_body[load] == static_cast<Index>(body);
    if (kind[load] != LoadKind::gravity) return true;
    for (std::size_t other = 0; other < kind.size(); ++other)
        if (kind[other] == LoadKind::gravity && load_body[other] == static_cast<Index>(body)) return false;
    return true;
}

bool add_loads(Executor& executor, const LoadInputs& loads, Column<BodyDrag>& drag, std::span<Vec3> applied_force) {
    if (loads.kind.empty()) return false;
    const auto scaled = [&](std::size_t load, std::size_t body) -> Vec3 {
        return loads.scale(load, body) * loads.vector[load];
    };
    drag.assign(loads.body_kind.size(), {});
    for (std::size_t load = 0; load < loads.kind.size(); ++load) switch (loads.kind[load]) {
            case LoadKind::force:
            case LoadKind::traction:
                add_to_nodes(executor, loads, load, applied_force);
                break;
            case LoadKind::acceleration:
                for_bodies_of_field(loads, load, [&](std::size_t body) {
                    accelerate(executor, loads, body, scaled(load, body), applied_force);
                });
                break;
            case LoadKind::gravity:
                // The forces of the step contain the weight itself, so only the difference is added.
                for_bodies_of_field(loads, load, [&](std::size_t body) {
                    accelerate(executor, loads, body, (loads.scale(load, body) - 1) * loads.gravity, applied_force);
                });
                break;
            case LoadKind::drag:
                for_bodies_of_field(loads, load, [&](std::size_t body) {
                    drag[body].rate += loads.rate[load];
                    drag[body].pull += loads.rate[load] * scaled(load, body);
                });
                break;
        }
    for (std::size_t body = 0; body < drag.size(); ++body) {
        const BodyDrag& of = drag[body];
        if (!(of.rate > 0)) continue;
        for_nodes(executor, loads.body_nodes[body], [&](std::size_t n) {
            applied_force[n] += loads.mass[n] * (of.pull - of.rate * loads.velocity[n]);
        });
    }
    return true;
}

bool mark_loaded(const LoadedBodies& loads, Real t, Real h, std::span<std::uint8_t> marked) {
    bool any = false;
    for (std::size_t load = 0; load < loads.load_body.size(); ++load) {
        if (!changes(rows_of(loads.key, loads.scale_keys[load]), t, h)) continue;
        any = true;
        if (loads.load_body[load] != no_index) {
            marked[static_cast<std::size_t>(loads.load_body[load])] = 1;
            continue;
        }
        for (std::size_t body = 0; body < loads.body_kind.size(); ++body)
            marked[body] |= loads.body_kind[body] == BodyKind::deformable;
    }
    return any;
}

bool find_driven(const LoadedBodies& loads, Real t, Real h, Column<std::uint8_t>& driven) {
    driven.clear();
    if (loads.load_body.empty()) return false;
    driven.assign(loads.body_kind.size(), 0);
    if (mark_loaded(loads, t, h, driven)) return true;
    driven.clear();
    return false;
}

}  // namespace skerry
