// Before the first step after something was added: overlaps are found, and taken apart, refused or left.
#include <algorithm>

#include "engine/world/start/start_messages.h"
#include "engine/world/start/start_search.h"
#include "engine/world/world_state.h"
#include "jobs/arithmetic_scope.h"

namespace skerry {

namespace {

StartOverlap report_of(const Model& model, const PairOverlap& found) {
    StartOverlap report;
    report.kind = found.overlap.kind;
    report.depth = found.overlap.depth;
    report.direction = found.overlap.direction;
    report.place = found.overlap.place;
    const auto first = static_cast<std::size_t>(found.pair.first), second = static_cast<std::size_t>(found.pair.second);
    report.first = model.body_map.handle_of_slot(model.bodies.slot[first]);
    report.first_name = model.body_records[first].name;
    const bool is_body = !found.pair.is_analytic && model.bodies.kind[second] == BodyKind::deformable;
    if (is_body) {
        report.second = model.body_map.handle_of_slot(model.bodies.slot[second]);
        report.second_name = model.body_records[second].name;
    } else {
        const auto row =
            static_cast<std::size_t>(found.pair.is_analytic ? found.pair.second : model.bodies.collider[second]);
        report.collider = model.collider_map.handle_of_slot(model.colliders.slot[row]);
        report.second_name = model.collider_records[row].name;
    }
    return report;
}

/// Moves bodies apart, pair after pair and round after round, until a round has nothing to move.
class MoveApart {
public:
    MoveApart(const Model& model, StartSearch& search) : model_(model), search_(search) {}

    void run(std::span<const PairOverlap> overlaps) {
        others_ = overlaps.size() - 1;
        for (const PairOverlap& found : overlaps) require_way_out(found);
        std::vector<char> marked(model_.bodies.slot.size(), 0);
        for (const auto& [pair, overlap] : overlaps) mark(pair, marked);
        // A long row of bodies passes on a push by a part in each round.
        constexpr int most_rounds = 1000;
        for (int round = 0; round < most_rounds; ++round) {
            std::vector<char> moved(marked.size(), 0);
            std::optional<PairOverlap> last;
            if (round > 0) others_ = 0;
            for (const StartPair& pair : search_.close_pairs(marked))
                if (const std::optional<Overlap> overlap = search_.look_at(pair)) {
                    last = PairOverlap{pair, *overlap};
                    require_way_out(*last);
                    push(*last);
                    mark(pair, moved);
                }
            if (!last) return;
            if (round + 1 == most_rounds) refuse(*last, "what is around them leaves no room");
            marked = std::move(moved);
        }
    }

private:
    [[noreturn]] void refuse(const PairOverlap& found, const std::string& why) const {
        refuse_overlap(report_of(model_, found), others_, why);
    }

    /// 1/kg; 0 for what stays where it is: what is held, what has made a step, a collider.
    Real mobility(Index body) const {
        const auto b = static_cast<std::size_t>(body);
        const bool stays = model_.bodies.kind[b] != BodyKind::deformable || model_.bodies.pinned_count[b] > 0 ||
                           model_.body_records[b].settled;
        return stays ? 0 : 1 / model_.body_mass[b];
    }
    Real mobility_of_second(const StartPair& pair) const { return pair.is_analytic ? 0 : mobility(pair.second); }

    void mark(const StartPair& pair, std::vector<char>& marked) const {
        if (mobility(pair.first) > 0) marked[static_cast<std::size_t>(pair.first)] = 1;
        if (mobility_of_second(pair) > 0) marked[static_cast<std::size_t>(pair.second)] = 1;
    }

    /// Half through, it is a matter of chance on which side the way out is shorter.
    Real deepest(const StartPair& pair) {
        Real thickness = search_.extent(pair.first).minCoeff();
        if (!pair.is_analytic && search_.has_inside(pair.second))
            thickness = std::min(thickness, search_.extent(pair.second).minCoeff());
        return thickness / 2;
    }

    void require_way_out(const PairOverlap& found) {
        if (found.overlap.kind != OverlapKind::crossing) refuse(found, "which way out is meant cannot be told");
        if (found.overlap.depth > deepest(found.pair))
            refuse(found, "that is more than half of the thinner one, so that which way out is meant cannot be told");
        if (!(mobility(found.pair.first) + mobility_of_second(found.pair) > 0))
            refuse(found, "neither may be moved: bodies that are attached or have made a step stay where they are");
    }

    /// By the shortest way; their common centre of mass stays.
    void push(const PairOverlap& found) {
        const Vec3 way = (found.overlap.depth + search_.margin(found.pair)) * found.overlap.direction;
        const Real first = mobility(found.pair.first), second = mobility_of_second(found.pair);
        if (first > 0) move(found, found.pair.first, first / (first + second) * way);
        if (second > 0) move(found, found.pair.second, -second / (first + second) * way);
    }

    void move(const PairOverlap& found, Index body, const Vec3& way) {
        search_.move(body, way);
        if (search_.shift(body).norm() > search_.extent(body).maxCoeff())
            refuse(found, "'" + model_.body_records[static_cast<std::size_t>(body)].name +
                              "' would have to go further than it is long");
    }

    const Model& model_;
    StartSearch& search_;
    std::size_t others_ = 0;  // overlaps beside the one that is looked at
};

std::vector<StartMove> take_over_shifts(const StartSearch& search, Model& model) {
    std::vector<StartMove> moves;
    for (std::size_t b = 0; b < model.bodies.slot.size(); ++b) {
        const Vec3& shift = search.shift(static_cast<Index>(b));
        if (shift == Vec3::Zero()) continue;
        for (Index n = model.bodies.nodes[b].begin; n < model.bodies.nodes[b].end; ++n) {
            model.nodes.position[n] += shift;
            model.nodes.displacement_origin[n] = model.nodes.position[n];
        }
        moves.push_back({model.body_map.handle_of_slot(model.bodies.slot[b]), model.body_records[b].name, shift});
    }
    return moves;
}

}  // namespace

void World::settle_start() {
    WorldState& world = *state_;
    Model& model = world.model;
    if (model.settled) return;
    const ArithmeticScope arithmetic;
    StartSearch search(model, world.clock.time);
    const std::vector<PairOverlap> overlaps = search.find_all();
    std::vector<StartOverlap> reports;
    for (const PairOverlap& found : overlaps) reports.push_back(report_of(model, found));
    const StartOverlaps wanted = model.settings.start_overlaps;
    if (!overlaps.empty() && wanted == StartOverlaps::refuse)
        refuse_overlap(reports.front(), reports.size() - 1, "start_overlaps is \"refuse\"");
    std::vector<StartMove> moves;
    if (!overlaps.empty() && wanted == StartOverlaps::resolve) {
        MoveApart(model, search).run(overlaps);
        moves = take_over_shifts(search, model);
        world.cache.drop_pairs(model);
        world.record.balance.close();
        for (StartOverlap& report : reports) report.resolved = true;
    }
    world.record.start_overlaps = std::move(reports);
    world.record.start_moves = std::move(moves);
    for (BodyRecord& body : model.body_records) body.settled = true;
    for (ColliderRecord& collider : model.collider_records) collider.settled = true;
    model.settled = true;
}

}  // namespace skerry
