// Finds overlaps of objects that were added since the last step, before the next step. The setting start_overlaps
// determines whether overlaps are resolved, refused or left unchanged.
#include <algorithm>
#include <map>

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

/// Moves overlapping bodies apart in rounds. Each round shifts bodies until all overlaps found so far have become gaps,
/// and then searches for new overlaps.
class MoveApart {
public:
    MoveApart(const Model& model, StartSearch& search) : model_(model), search_(search) {}

    void run(std::span<const PairOverlap> overlaps) {
        others_ = overlaps.size() - 1;
        std::vector<PairOverlap> found(overlaps.begin(), overlaps.end());
        constexpr int most_rounds = 100;
        for (int round = 0; !found.empty(); ++round, others_ = 0) {
            if (round == most_rounds)
                refuse(found.front(), "the surrounding bodies and colliders leave no room to move them apart");
            for (const PairOverlap& each : found) {
                require_resolvable(each);
                ask_for(each);
            }
            const std::vector<Vec3> before(search_.shifts().begin(), search_.shifts().end());
            satisfy();
            std::vector<char> moved(before.size(), 0);
            for (std::size_t b = 0; b < moved.size(); ++b) moved[b] = before[b] != search_.shifts()[b];
            for (const PairOverlap& each : found) require_near(each);
            found.clear();
            for (const StartPair& pair : search_.close_pairs(moved))
                if (const std::optional<Overlap> overlap = search_.overlap_of(pair)) found.push_back({pair, *overlap});
        }
    }

private:
    /// A gap that an overlapping pair needs: the first body must be shifted by at least `least` along `direction`,
    /// relative to the second body.
    struct Gap {
        Vec3 direction;  // unit vector
        Real least;      // [m]
    };

    [[noreturn]] void refuse(const PairOverlap& found, const std::string& reason) const {
        refuse_overlap(report_of(model_, found), others_, reason);
    }

    /// Inverse mass of a body [1/kg]; 0 for a body that must not be moved. Three kinds of bodies must not be moved:
    /// held bodies, bodies that an earlier call of settle_start has checked, and the bodies of mesh colliders.
    Real mobility(Index body) const {
        const auto b = static_cast<std::size_t>(body);
        const bool stays = model_.bodies.kind[b] != BodyKind::deformable || model_.body_records[b].settled ||
                           std::ranges::find(model_.attachments.body, body) != model_.attachments.body.end();
        return stays ? 0 : 1 / model_.body_mass[b];
    }
    Real mobility_of_second(const StartPair& pair) const { return pair.is_analytic ? 0 : mobility(pair.second); }

    /// Largest depth of an overlap that can be resolved [m]: half the thickness of the thinner object, where the
    /// thickness is the shortest edge of its bounding box. In a deeper overlap, the shortest way out may lead to the
    /// wrong side.
    Real deepest(const StartPair& pair) {
        Real thickness = search_.extent(pair.first).minCoeff();
        if (!pair.is_analytic && search_.has_inside(pair.second))
            thickness = std::min(thickness, search_.extent(pair.second).minCoeff());
        return thickness / 2;
    }

    void require_resolvable(const PairOverlap& found) {
        const bool in_surface = !found.pair.is_analytic && found.overlap.kind == OverlapKind::inside &&
                                model_.bodies.kind[found.pair.second] == BodyKind::kinematic;
        if (in_surface)
            refuse(found,
                   "a mesh collider is solid inside its surface; to use it as a container, orient its triangles "
                   "counter-clockwise as seen from inside");
        if (found.overlap.kind != OverlapKind::crossing)
            refuse(found, "the direction that separates them is ambiguous");
        if (found.overlap.depth > deepest(found.pair))
            refuse(
                found,
                "the depth exceeds half the thickness of the thinner object, so the direction that separates them is "
                "ambiguous");
        if (!(mobility(found.pair.first) + mobility_of_second(found.pair) > 0))
            refuse(
                found,
                "neither object can be moved, because colliders, attached bodies and bodies that have made a step keep "
                "their positions");
    }

    void require_near(const PairOverlap& found) const {
        const auto check = [&](Index body) {
            if (search_.shift(body).norm() > search_.extent(body).maxCoeff())
                refuse(found, "body '" + model_.body_records[static_cast<std::size_t>(body)].name +
                                  "' would have to move farther than its own size");
        };
        check(found.pair.first);
        if (!found.pair.is_analytic) check(found.pair.second);
    }

    Real shift_along(const StartPair& pair, const Vec3& direction) const {
        const Real first = direction.dot(search_.shift(pair.first));
        return pair.is_analytic ? first : first - direction.dot(search_.shift(pair.second));
    }

    /// Adds the gap that an overlap requires to the list of its pair. It replaces earlier gaps in nearly the same
    /// direction. A body in a corner of another object needs gaps in several directions, so a pair may have several
    /// gaps.
    void ask_for(const PairOverlap& found) {
        // a gap is replaced if the cosine of the angle between both directions is above this value
        constexpr Real about_the_same = 0.9;
        const Vec3& direction = found.overlap.direction;
        const Gap gap{direction, shift_along(found.pair, direction) + found.overlap.depth + search_.margin(found.pair)};
        std::vector<Gap>& gaps = gaps_[found.pair];
        std::erase_if(gaps, [&](const Gap& other) { return other.direction.dot(direction) > about_the_same; });
        gaps.push_back(gap);
    }

    /// Shifts one pair after the other, in repeated sweeps, until all pairs have their required gaps up to a tolerance.
    /// If both bodies of a pair can move, their common centre of mass stays in place.
    void satisfy() {
        constexpr int most_sweeps = 1000;
        constexpr Real slack = 0.1;  // tolerance of a gap, divided by the margin of the pair
        bool moving = true;
        for (int sweep = 0; sweep < most_sweeps && moving; ++sweep) {
            moving = false;
            for (const auto& [pair, gaps] : gaps_)
                for (const Gap& gap : gaps) {
                    const Real missing = gap.least - shift_along(pair, gap.direction);
                    if (!(missing > 0)) continue;
                    moving |= missing > slack * search_.margin(pair);
                    const Real first = mobility(pair.first), second = mobility_of_second(pair);
                    if (first > 0) search_.move(pair.first, first / (first + second) * missing * gap.direction);
                    if (second > 0) search_.move(pair.second, -second / (first + second) * missing * gap.direction);
                }
        }
    }

    const Model& model_;
    StartSearch& search_;
    // sorted, because the result depends on the order in which pairs are shifted
    std::map<StartPair, std::vector<Gap>> gaps_;
    std::size_t others_ = 0;  // number of further overlaps that an error message mentions
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
        if (model.has_frame(b))
            model.rigid_bodies.center[static_cast<std::size_t>(model.bodies.rigid[b].begin)] += shift;
        moves.push_back({model.body_map.handle_of_slot(model.bodies.slot[b]), model.body_records[b].name, shift});
    }
    return moves;
}

}  // namespace

void World::settle_start() {
    WorldState& world = *state_;
    Model& model = world.model;
    if (model.settled) return;
    world.require_between_steps("settle_start");
    world.settle();
    const ArithmeticScope arithmetic;
    StartSearch search(model, world.clock.time);
    const std::vector<PairOverlap> overlaps = search.find_all();
    std::vector<StartOverlap> reports;
    for (const PairOverlap& found : overlaps) reports.push_back(report_of(model, found));
    const StartOverlaps treatment = model.settings.start_overlaps;
    if (!overlaps.empty() && treatment == StartOverlaps::refuse)
        refuse_overlap(reports.front(), reports.size() - 1, "the setting start_overlaps is \"refuse\"");
    std::vector<StartMove> moves;
    if (!overlaps.empty() && treatment == StartOverlaps::resolve) {
        MoveApart(model, search).run(overlaps);
        moves = take_over_shifts(search, model);
        for (const StartMove& move : moves)
            world.cache.forget_body(model, static_cast<std::size_t>(model.row(move.body, "settle_start")));
        world.query_trees.forget();
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
