#include "systems/forces/add_loads.h"

#include <algorithm>
#include <cmath>

#include "jobs/parallel_for.h"
#include "systems/forces/cavities.h"

namespace skerry {

namespace {

constexpr std::size_t loaded_nodes_per_block = 4096;

/// Mean scales of a load in this step.
struct MeanScales {
    Real explicit_scale;  // for explicit and rigid bodies
    Real implicit_scale;  // for implicit bodies

    MeanScales(const LoadInputs& loads, std::size_t load) {
        const std::span<const TimeKey> keys = rows_of(loads.key, loads.scale_keys[load]);
        const ForceIntervals& during = loads.intervals;
        explicit_scale = mean_value(keys, during.begin, during.length);
        implicit_scale = mean_value(keys, during.begin_implicit, during.length_implicit);
    }
    Real at(const LoadInputs& loads, std::size_t body) const {
        return loads.body_implicit[body].size() > 0 ? implicit_scale : explicit_scale;
    }
};

void add_to_nodes(Executor& executor, const LoadInputs& loads, std::size_t load, Real scale, std::span<Vec3> force) {
    const std::span<const Index> nodes = rows_of(loads.share_node, loads.load_nodes[load]);
    const std::span<const Real> weight = rows_of(loads.weight, loads.load_nodes[load]);
    const Vec3 whole = scale * loads.vector[load];
    const Index first = loads.body_nodes[static_cast<std::size_t>(loads.load_body[load])].begin;
    parallel_for(executor, nodes.size(), loaded_nodes_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            force[static_cast<std::size_t>(first + nodes[i])] += weight[i] * whole;
    });
}

/// Adds a traction on the present area. Sequential, because faces share nodes.
void add_to_faces(const LoadInputs& loads, std::size_t load, Real scale, std::span<Vec3> force) {
    const Index first = loads.body_nodes[static_cast<std::size_t>(loads.load_body[load])].begin;
    loads.for_each_face(load, [&](std::size_t k, const Mat3& corners) {
        const Vec3 node_force = area_of(corners).norm() / 3 * scale * loads.vector[load];
        for (std::size_t c = k; c < k + 3; ++c)
            force[static_cast<std::size_t>(first + loads.share_node[c])] += node_force;
    });
}

/// Adds a field to the sum of the fields on one body.
void add_field(const LoadInputs& loads, std::size_t load, Real scale, BodyField& sum) {
    switch (loads.kind[load]) {
        case LoadKind::acceleration:
            sum.acceleration += scale * loads.vector[load];
            break;
        case LoadKind::gravity:
            // The step adds the weight (gravity with the factor 1) elsewhere, so only the difference is added here.
            sum.acceleration += (scale - 1) * loads.gravity;
            break;
        case LoadKind::drag:
            sum.acceleration += loads.rate[load] * scale * loads.vector[load];
            sum.drag += loads.rate[load];
            break;
        case LoadKind::force:
        case LoadKind::traction:
            break;
    }
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

bool add_loads(Executor& executor, const LoadInputs& loads, Column<BodyField>& fields, std::span<Vec3> applied_force) {
    if (loads.kind.empty()) return false;
    fields.assign(loads.body_kind.size(), {});
    bool any_field = false;
    for (std::size_t load = 0; load < loads.kind.size(); ++load) {
        const MeanScales scales(loads, load);
        if (loads.load_nodes[load].size() > 0) {
            const Real scale = scales.at(loads, static_cast<std::size_t>(loads.load_body[load]));
            if (loads.is_on_present_area(load))
                add_to_faces(loads, load, scale, applied_force);
            else
                add_to_nodes(executor, loads, load, scale, applied_force);
            continue;
        }
        any_field = true;
        for (std::size_t body = 0; body < fields.size(); ++body)
            if (loads.acts_on(load, body)) add_field(loads, load, scales.at(loads, body), fields[body]);
    }
    if (!any_field) return true;
    parallel_for(executor, applied_force.size(), loaded_nodes_per_block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const BodyField& field = fields[static_cast<std::size_t>(loads.node_body[n])];
            applied_force[n] += loads.mass[n] * (field.acceleration - field.drag * loads.velocity[n]);
        }
    });
    return true;
}

Real traction_rate(const LoadInputs& loads, std::size_t load, std::span<const Real> inverse_mass) {
    const Index first = loads.body_nodes[static_cast<std::size_t>(loads.load_body[load])].begin;
    Real scale = 0, most = 0;
    for (const TimeKey& key : rows_of(loads.key, loads.scale_keys[load])) scale = std::max(scale, std::abs(key.value));
    loads.for_each_face(load, [&](std::size_t k, const Mat3& corners) {
        for (std::size_t c = k; c < k + 3; ++c)
            most = std::max(most, loads.weight[c] * longest_edge(corners) *
                                      inverse_mass[static_cast<std::size_t>(first + loads.share_node[c])]);
    });
    return scale * loads.vector[load].norm() / 2 * most;
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

}  // namespace skerry
