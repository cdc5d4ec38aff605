// Stage in which all ranks combine their findings, so that all of them commit or abandon the attempt at a step.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "components/element_table.h"
#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

namespace {

/// Columns that convert rows of this rank's tables to numbers that mean the same on all ranks, and columns that tell
/// whether a body moves or may be too far from the origin in the next step.
struct NamedBodies {
    std::span<const Index> place;         // by body: its row in the undivided world
    std::span<const std::int32_t> owner;  // RankState
    std::span<const Range> nodes;         // BodyTable
    std::span<const Range> tetrahedron_blocks;
    std::span<const BodyKind> kind;
    std::span<const std::uint8_t> asleep;
    std::span<const Real> max_speed;  // [m/s]
    std::span<const Real> mean_edge;  // [m]
    std::span<const Vec3> position;   // by node [m]
    int rank;

    static NamedBodies bind(const Binder& binder, const RankState& ranks, const BodyTable& body,
                            const NodeTable& node) {
        return {.place = binder.read(ranks.place),
                .owner = binder.read(ranks.owner),
                .nodes = binder.read(body.nodes),
                .tetrahedron_blocks = binder.read(body.tetrahedron_blocks),
                .kind = binder.read(body.kind),
                .asleep = binder.read(body.asleep),
                .max_speed = binder.read(body.max_speed),
                .mean_edge = binder.read(body.mean_edge),
                .position = binder.read(node.position),
                .rank = binder.value(ranks.rank)};
    }
    bool owns(Index body) const { return owner[body] == rank; }
    Index place_of(Index body) const { return body == no_index ? RankFindings::nobody : place[body]; }
    Index tetrahedron(Index body, Index lane) const {
        return lane == no_index ? no_index : lane - tetrahedron_blocks[body].begin * Index{element_lanes};
    }
    bool moves(std::size_t body) const {
        return (kind[body] == BodyKind::deformable && !asleep[body]) || max_speed[body] != 0;
    }
    /// True if the first node of the body may be too far from the origin (check_distance) after two steps of length `h`
    /// [s]. The outer factor 2 is a safety margin. NaN counts as too far.
    bool may_be_far(std::size_t body, Real h) const {
        if (nodes[body].size() == 0) return false;
        const Real distance = position[static_cast<std::size_t>(nodes[body].begin)].cwiseAbs().maxCoeff();
        const Real farthest = coarsest_spacing * mean_edge[body] / std::numeric_limits<Real>::epsilon();
        return mean_edge[body] > 0 && !(2 * (distance + 2 * h * max_speed[body]) < farthest);
    }
};

/// Findings of the stages of this rank. take_findings replaces the mutable ones by the findings of all ranks.
struct StageFindings {
    const ContactMeasures& measures;
    const Index& unstrained;
    StepVerdict& verdict;
    StrainFindings& strained;
    Inversions& inversions;
    std::span<const InversionPart> inversion_parts;
    Index& crossings;
    CrossingTable& table;

    static StageFindings bind(const Binder& binder, StepFindings& found, const InversionMemory& inversions,
                              CrossingTable& table) {
        return {.measures = binder.read(found.measures),
                .unstrained = binder.read(found.unstrained),
                .verdict = binder.make(found.verdict),
                .strained = binder.make(found.strained),
                .inversions = binder.make(found.inversions),
                .inversion_parts = binder.read(inversions.part),
                .crossings = binder.make(found.crossings),
                .table = binder.make(table)};
    }
};

/// Counts the inverted tetrahedra of bodies that this rank owns, and names the first one. The owners of ghosts count
/// theirs.
void note_inversions(const NamedBodies& bodies, const StageFindings& found, RankFindings& mine) {
    mine.inverts_first = found.inversions.first;
    for (const InversionPart& part : found.inversion_parts) {
        if (part.count == 0 || !bodies.owns(part.body)) continue;
        if (mine.inversions == 0) {
            mine.inverted_body = bodies.place_of(part.body);
            mine.inverted_tetrahedron = bodies.tetrahedron(part.body, part.tetrahedron);
        }
        mine.inversions += part.count;
    }
}

/// Copies the findings of the stages to `mine`, with numbers of bodies, nodes and tetrahedra that are valid on all
/// ranks.
void note_findings(const NamedBodies& bodies, const StageFindings& found, Real h, RankFindings& mine) {
    const StepVerdict& verdict = found.verdict;
    mine.fault = verdict.fault;
    mine.fault_body = bodies.place_of(verdict.body);
    if (verdict.node != no_index) mine.fault_node = verdict.node - bodies.nodes[verdict.body].begin;
    mine.fault_tetrahedron = bodies.tetrahedron(verdict.body, verdict.tetrahedron);
    mine.fault_value = verdict.value;
    mine.strain_rate = verdict.fastest.rate;
    mine.strained_body = bodies.place_of(verdict.fastest.body);
    mine.unsolved_body = bodies.place_of(found.strained.unsolved);
    if (found.inversions.count > 0) note_inversions(bodies, found, mine);
    mine.crossings = found.crossings;
    mine.beyond_lists = found.table.beyond_lists;
    for (std::size_t b = 0; b < bodies.place.size(); ++b) {
        mine.moves |= bodies.moves(b);
        mine.far |= bodies.may_be_far(b, h);
    }
}

Index or_none(Index place) {
    return place == RankFindings::nobody ? no_index : place;
}

/// Replaces the findings of the stages by those of all ranks. Bodies are named by their rows in the undivided world
/// afterwards.
void take_findings(const RankFindings& all, const StageFindings& found) {
    found.verdict = {.fault = all.fault,
                     .body = or_none(all.fault_body),
                     .node = all.fault_node,
                     .value = all.fault_value,
                     .tetrahedron = all.fault_tetrahedron,
                     .fastest = {all.strain_rate, or_none(all.strained_body)}};
    if (all.fault == StepFault::not_finite) found.verdict.fastest = {};
    found.strained.unsolved = or_none(all.unsolved_body);
    // The findings must equal those of a process that simulates the whole world. That process tests for inversions and
    // crossings only if no body has a fault, and for crossings only if no candidate list is too short.
    const bool tested = all.fault == StepFault::none;
    found.inversions =
        tested ? Inversions{all.inversions, or_none(all.inverted_body), all.inverted_tetrahedron, all.inverts_first}
               : Inversions{};
    found.table.beyond_lists = tested && all.beyond_lists;
    found.crossings = tested ? all.crossings : 0;
    if (!tested || all.beyond_lists || all.again_over_ranks()) found.table.found_count = 0;
    // A nonzero number of crossings keeps the stages that commit the step from running. judge() does not read this
    // number, because it checks for again_over_ranks first.
    if (all.again_over_ranks()) found.crossings = 1;
}

void reduce_findings(const NamedBodies& bodies, const ContactTable& contacts, const RegionTable& regions, const Real& h,
                     const StageFindings& found, RankFindings& mine, RankFindings& all, RankChannel& channel) {
    note_findings(bodies, found, h, mine);
    mine.pushed = regions.pushed;
    mine.counters = count_step(contacts, regions, found.measures, found.strained.newton, found.unstrained);
    all = mine;
    reduce<combine>(*channel.ranks, all);
    all.counters.steps = 1;
    take_findings(all, found);
}

}  // namespace

void list_reduction(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/reduce_findings", reduce_findings, inputs<NamedBodies>(w.ranks, w.model.bodies, w.model.nodes),
            read(w.scratch.contacts), read(w.scratch.regions), value(w.scratch.parameters.h),
            outputs<StageFindings>(w.scratch.findings, w.scratch.inversions, w.cache.crossings), make(w.ranks.mine),
            make(w.ranks.all), make(w.ranks.channel));
}

void agree_to_start(WorldState& w) {
    RankState& ranks = w.ranks;
    if (!ranks.on()) return;
    const bool possible = !ranks.all.moves || ranks.all.far;
    bool& left_out = w.scratch.left_out;
    StepVerdict& verdict = w.scratch.findings.verdict;
    ranks.mine = {};
    ranks.mine.stop = ranks.stops;
    if (!possible) {
        left_out = false;
        return;
    }
    ranks.all = ranks.mine;
    ranks.all.moves = !left_out;
    if (verdict.fault != StepFault::none) {
        ranks.all.fault = verdict.fault;
        ranks.all.fault_body = ranks.place_of(verdict.body);
        ranks.all.fault_value = verdict.value;
    }
    reduce<combine>(*ranks.ranks, ranks.all);
    left_out = !ranks.all.moves;
    verdict = {};
    if (!left_out && ranks.all.fault != StepFault::none)
        verdict = {.fault = ranks.all.fault, .body = ranks.all.fault_body, .value = ranks.all.fault_value};
}

}  // namespace skerry
