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
    std::span<const Index> world_row;     // by body: its row in the undivided world
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
        return {.world_row = binder.read(ranks.world_row),
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
    Index world_row_of(Index body) const { return body == no_index ? RankFindings::nobody : world_row[body]; }
    Index tetrahedron(Index body, Index lane) const {
        return lane == no_index ? no_index : lane - tetrahedron_blocks[body].begin * Index{element_lanes};
    }
    bool moves(std::size_t body) const {
        return (kind[body] == BodyKind::deformable && !asleep[body]) || max_speed[body] != 0;
    }
    /// True if the first node of the body may be too far from the origin (check_distance) after two steps of length `h`
    /// [s]. The outer factor 2 is a safety margin, also for the other nodes. NaN counts as too far.
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

/// Counts the inverted tetrahedra of bodies that this rank owns, and names the first one. Tetrahedra of ghosts (copies
/// of other bodies) are counted by the ranks that own these bodies.
void note_inversions(const NamedBodies& bodies, const StageFindings& found, RankFindings& own_findings) {
    own_findings.inverts_first = found.inversions.is_first_of_body;
    for (const InversionPart& part : found.inversion_parts) {
        if (part.count == 0 || !bodies.owns(part.body)) continue;
        if (own_findings.inversions == 0) {
            own_findings.inverted_body = bodies.world_row_of(part.body);
            own_findings.inverted_tetrahedron = bodies.tetrahedron(part.body, part.tetrahedron);
        }
        own_findings.inversions += part.count;
    }
}

/// Copies the findings of the stages to `own_findings`, with numbers of bodies, nodes and tetrahedra that are valid on
/// all ranks.
void note_findings(const NamedBodies& bodies, const StageFindings& found, Real h, RankFindings& own_findings) {
    const StepVerdict& verdict = found.verdict;
    own_findings.fault = verdict.fault;
    own_findings.fault_body = bodies.world_row_of(verdict.body);
    if (verdict.node != no_index) own_findings.fault_node = verdict.node - bodies.nodes[verdict.body].begin;
    own_findings.fault_tetrahedron = bodies.tetrahedron(verdict.body, verdict.tetrahedron);
    own_findings.fault_value = verdict.value;
    own_findings.strain_rate = verdict.fastest.rate;
    own_findings.strained_body = bodies.world_row_of(verdict.fastest.body);
    own_findings.unsolved_body = bodies.world_row_of(found.strained.unsolved);
    if (found.inversions.count > 0) note_inversions(bodies, found, own_findings);
    own_findings.crossings = found.crossings;
    own_findings.beyond_lists = found.table.beyond_lists;
    for (std::size_t b = 0; b < bodies.world_row.size(); ++b) {
        own_findings.moves |= bodies.moves(b);
        own_findings.far |= bodies.may_be_far(b, h);
    }
}

Index or_none(Index world_row) {
    return world_row == RankFindings::nobody ? no_index : world_row;
}

/// Replaces the findings of the stages by those of all ranks. Bodies are named by their rows in the undivided world
/// afterwards.
void take_findings(const RankFindings& all_findings, const StageFindings& found) {
    found.verdict = {.fault = all_findings.fault,
                     .body = or_none(all_findings.fault_body),
                     .node = all_findings.fault_node,
                     .value = all_findings.fault_value,
                     .tetrahedron = all_findings.fault_tetrahedron,
                     .fastest = {all_findings.strain_rate, or_none(all_findings.strained_body)}};
    if (all_findings.fault == StepFault::not_finite) found.verdict.fastest = {};
    found.strained.unsolved = or_none(all_findings.unsolved_body);
    // The findings must equal those of a process that simulates the whole world. It tests for inversions and crossings
    // only if no body has a fault. It tests for crossings only if, moreover, its lists of contact candidates (features
    // that may touch) are long enough (beyond_lists).
    const bool tested = all_findings.fault == StepFault::none;
    found.inversions = tested ? Inversions{all_findings.inversions, or_none(all_findings.inverted_body),
                                           all_findings.inverted_tetrahedron, all_findings.inverts_first}
                              : Inversions{};
    found.table.beyond_lists = tested && all_findings.beyond_lists;
    found.crossings = tested ? all_findings.crossings : 0;
    if (!tested || all_findings.beyond_lists || all_findings.again_over_ranks()) found.table.found_count = 0;
    // A nonzero number of crossings keeps the stages that commit the step from running. judge() does not read this
    // number, because it checks for again_over_ranks first.
    if (all_findings.again_over_ranks()) found.crossings = 1;
}

void reduce_findings(const NamedBodies& bodies, const ContactTable& contacts, const RegionTable& regions, const Real& h,
                     const StageFindings& found, RankFindings& own_findings, RankFindings& all_findings,
                     RankChannel& channel) {
    note_findings(bodies, found, h, own_findings);
    own_findings.pushed = regions.pushed;
    own_findings.counters = count_step(contacts, regions, found.measures, found.strained.newton, found.unstrained);
    all_findings = own_findings;
    reduce<combine>(*channel.ranks, all_findings);
    all_findings.counters.steps = 1;
    take_findings(all_findings, found);
}

}  // namespace

void list_reduction(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/reduce_findings", reduce_findings, inputs<NamedBodies>(w.ranks, w.model.bodies, w.model.nodes),
            read(w.scratch.contacts), read(w.scratch.regions), value(w.scratch.parameters.h),
            outputs<StageFindings>(w.scratch.findings, w.scratch.inversions, w.cache.crossings),
            make(w.ranks.own_findings), make(w.ranks.all_findings), make(w.ranks.channel));
}

void agree_to_start(WorldState& w) {
    RankState& ranks = w.ranks;
    if (!ranks.on()) return;
    const bool possible = !ranks.all_findings.moves || ranks.all_findings.far;
    bool& skipped = w.scratch.skipped;
    StepVerdict& verdict = w.scratch.findings.verdict;
    ranks.own_findings = {};
    ranks.own_findings.stop = ranks.stops;
    if (!possible) {
        skipped = false;
        return;
    }
    ranks.all_findings = ranks.own_findings;
    ranks.all_findings.moves = !skipped;
    if (verdict.fault != StepFault::none) {
        ranks.all_findings.fault = verdict.fault;
        ranks.all_findings.fault_body = ranks.world_row_of(verdict.body);
        ranks.all_findings.fault_value = verdict.value;
    }
    reduce<combine>(*ranks.ranks, ranks.all_findings);
    skipped = !ranks.all_findings.moves;
    verdict = {};
    if (!skipped && ranks.all_findings.fault != StepFault::none)
        verdict = {.fault = ranks.all_findings.fault,
                   .body = ranks.all_findings.fault_body,
                   .value = ranks.all_findings.fault_value};
}

}  // namespace skerry
