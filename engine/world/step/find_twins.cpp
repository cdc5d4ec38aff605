#include "engine/world/step/find_twins.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <span>
#include <tuple>

namespace skerry {

namespace {

/// Compares rows bitwise and not by value, so that a NaN equals a NaN with the same bits.
template <class Rows>
bool same_bits(const Rows& a, const Rows& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

bool same_local_nodes(std::span<const NodeLane> a, Index first_of_a, std::span<const NodeLane> b, Index first_of_b) {
    return std::ranges::equal(a, b, [&](const NodeLane& x, const NodeLane& y) {
        return std::equal(x.lane, x.lane + element_lanes, y.lane,
                          [&](Index p, Index q) { return p - first_of_a == q - first_of_b; });
    });
}

bool are_alike(const Model& model, std::size_t a, std::size_t b) {
    const auto alike = [&](const auto& column, const Column<Range>& ranges) {
        return same_bits(rows_of(column, ranges[a]), rows_of(column, ranges[b]));
    };
    const BodyTable& bodies = model.bodies;
    const ElementBlockTable& e = model.elements;
    return alike(e.count, bodies.blocks) && alike(e.material, bodies.blocks) && alike(e.part, bodies.blocks) &&
           alike(e.volume, bodies.blocks) && alike(e.relaxing_share, bodies.blocks) &&
           alike(e.relaxation_rate, bodies.blocks) && alike(e.own_frequency, bodies.blocks) &&
           alike(e.spring_strain, bodies.blocks) && alike(model.nodes.mass, bodies.nodes) &&
           alike(model.nodes.inverse_mass, bodies.nodes) && alike(model.nodes.rest_position, bodies.nodes) &&
           alike(model.element_nodes.gradient, bodies.element_nodes) &&
           same_local_nodes(rows_of(model.element_nodes.node, bodies.element_nodes[a]), bodies.nodes[a].begin,
                            rows_of(model.element_nodes.node, bodies.element_nodes[b]), bodies.nodes[b].begin);
}

}  // namespace

std::vector<std::size_t> find_twins(const Model& model) {
    std::vector<std::size_t> twin;
    // First bodies of the groups of equal bodies found so far. The key (number of nodes, number of element blocks,
    // stable step at rest) saves comparisons of bodies that differ.
    std::map<std::tuple<Index, Index, Real>, std::vector<std::size_t>> first_of;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        std::vector<std::size_t>& first =
            first_of[{model.bodies.nodes[b].size(), model.bodies.blocks[b].size(), model.bodies.rest_step[b]}];
        const auto found = std::ranges::find_if(first, [&](std::size_t a) { return are_alike(model, a, b); });
        twin.push_back(found == first.end() ? b : *found);
        if (twin.back() == b) first.push_back(b);
    }
    return twin;
}

}  // namespace skerry
