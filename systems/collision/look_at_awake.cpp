#include "systems/collision/look_at_awake.h"

#include <algorithm>

#include "systems/collision/look_at_candidates.h"
#include "systems/collision/pair_look.h"

namespace skerry {

void AwakeCandidates::add(Index p, Range range) {
    const Candidate* const list = pairs_.candidates[p].data();
    std::size_t begin = count_;
    const auto close_pair = [&] {
        if (begin < count_) pair_[pair_count_++] = {p, begin, count_, count_, 0, 0};
    };
    for_each_awake(pairs_.asleep_until[p].span(), range, pairs_.travel_bound[p], [&](Index c) {
        if (count_ == most_candidates) {
            close_pair();
            look();
            begin = 0;
        }
        __builtin_prefetch(list + c);  // without it each load would wait for the one before
        row_[count_++] = c;
    });
    close_pair();
}

void AwakeCandidates::look() {
    list_kinds();
    list_nodes(points_);
    list_nodes(edges_);
    measure_distances(points_);
    measure_distances(edges_);
    close_points_.count = close_edges_.count = 0;
    for (std::size_t i = 0; i < pair_count_; ++i) put_to_sleep(pair_[i]);
    measure_speeds(close_points_);
    measure_speeds(close_edges_);
    std::size_t next_point = 0, next_edge = 0;
    for (std::size_t i = 0; i < pair_count_; ++i) wake(pair_[i], next_point, next_edge);
    count_ = pair_count_ = 0;
}

/// Lists the points and the edges. In each pair's list points come before edges.
void AwakeCandidates::list_kinds() {
    points_.count = edges_.count = 0;
    const SurfaceTables& surface = inputs_.surface;
    for (std::size_t i = 0; i < pair_count_; ++i) {
        AwakePair& awake = pair_[i];
        const Candidate* const list = pairs_.candidates[awake.pair].data();
        std::size_t edges = 0;
        for (std::size_t place = awake.begin; place < awake.end; ++place) {
            const Candidate& candidate = candidate_[place] = list[row_[place]];
            const bool edge = features_of(candidate) == FeaturePair::edge_edge;
            __builtin_prefetch(edge ? static_cast<const void*>(&surface.edges.node[candidate.first])
                                    : &surface.vertices.node[candidate.first]);
            __builtin_prefetch(edge ? static_cast<const void*>(&surface.edges.node[candidate.second])
                                    : &surface.triangles.node[candidate.second]);
            points_.push_back_if(!edge, place);
            edges_.push_back_if(edge, place);
            edges += edge;
        }
        awake.edges_begin = awake.end - edges;
    }
}

void AwakeCandidates::list_nodes(const Places& places) {
    for (std::size_t i = 0; i < places.count; ++i)
        node_[places.place[i]] = nodes_of(inputs_.surface, candidate_[places.place[i]]);
}

CandidateNodeLanes AwakeCandidates::nodes_of_lanes(const Places& places, std::size_t first) const {
    CandidateNodeLanes lanes;
    for (std::size_t lane = 0; lane < candidate_lanes; ++lane)
        set_lane(lanes, lane, node_[places.place[first + lane < places.count ? first + lane : first]]);
    return lanes;
}

void AwakeCandidates::measure_distances(const Places& places) {
    for (std::size_t first = 0; first < places.count; first += candidate_lanes) {
        const auto found = distances(places.kind, inputs_.position, nodes_of_lanes(places, first));
        const std::size_t used = std::min(candidate_lanes, places.count - first);
        for (std::size_t lane = 0; lane < used; ++lane) distance_[places.place[first + lane]] = found[lane];
    }
}

void AwakeCandidates::measure_speeds(const Places& places) {
    for (std::size_t first = 0; first < places.count; first += candidate_lanes) {
        const auto found = relative_speeds(places.kind, inputs_.velocity, nodes_of_lanes(places, first));
        const std::size_t used = std::min(candidate_lanes, places.count - first);
        for (std::size_t lane = 0; lane < used; ++lane) speed_[places.place[first + lane]] = found[lane];
    }
}

PairScale AwakeCandidates::scale_of(Index p) const {
    return pair_scale_as_known(settings_, pairs_.state[p],
                               pair_scale(inputs_, pairs_.kind[p], pairs_.first[p], pairs_.second[p]));
}

/// Stores until when the candidates of a pair may sleep, judged by the greatest speeds of the pair.
void AwakeCandidates::put_to_sleep(AwakePair& awake) {
    const PairScale scale = scale_of(awake.pair);
    put_to_sleep(awake, awake.begin, awake.edges_begin, scale.zone, scale, close_points_);
    put_to_sleep(awake, awake.edges_begin, awake.end, scale.edge_depth, scale, close_edges_);
    awake.close_points_end = close_points_.count;
    awake.close_edges_end = close_edges_.count;
}

/// Stores until when candidates of one kind may sleep. There are no branches, since they would be hard to predict.
void AwakeCandidates::put_to_sleep(const AwakePair& awake, std::size_t begin, std::size_t end, Real zone,
                                   const PairScale& scale, Places& close) {
    if (begin == end) return;
    const Index p = awake.pair;
    const Real travel_base = pair_travel_base(inputs_, pairs_, p), far_until = travel_base - zone,
               close_until = travel_base - scale.edge_depth, radii = scale.radii,
               limit = std::max(nearness(scale, pairs_.closing[p]), zone),
               can_meet = (pairs_.travel_bound[p] - pairs_.travel[p]) / slow_fraction;
    Real* const asleep_until = pairs_.asleep_until[p].data();
    Real least = least_distance_;
    ByPlace<std::uint16_t> meeting;
    std::size_t meeting_count = 0;
    for (std::size_t place = begin; place < end; ++place) {
        const Real distance = distance_[place], apart = distance - radii;
        const bool is_close = distance <= limit;
        asleep_until[row_[place]] = distance + (is_close ? close_until : far_until);
        close.push_back_if(is_close, place);
        least = apart < least ? apart : least;
        meeting[meeting_count] = static_cast<std::uint16_t>(place);
        meeting_count += apart < can_meet;
    }
    least_distance_ = least;
    for (std::size_t i = 0; i < meeting_count; ++i) near_.push_back({p, row_[meeting[i]], distance_[meeting[i]]});
}

/// Tests the close candidates that are not too slow. If surfaces may overlap, slow ones are tested, too: they may have
/// come through.
void AwakeCandidates::wake(const AwakePair& awake, std::size_t& next_point, std::size_t& next_edge) {
    if (next_point == awake.close_points_end && next_edge == awake.close_edges_end) return;
    const Index p = awake.pair;
    const PairScale scale = scale_of(p);
    const bool held_apart = is_held_apart(settings_, pairs_.state[p], scale);
    ByPlace<Index> counts;
    std::size_t count = 0;
    const auto choose = [&](const Places& close, std::size_t& next, std::size_t end) {
        for (; next < end; ++next) {
            const std::size_t place = close.place[next];
            counts[count] = row_[place];
            count += !held_apart || distance_[place] - scale.contact_distance <=
                                        reach(h_, speed_[place], settings_.gravity, scale.shell);
        }
    };
    choose(close_points_, next_point, awake.close_points_end);
    choose(close_edges_, next_edge, awake.close_edges_end);
    if (count > 0)
        look_at_candidates(inputs_, settings_, h_, p, std::span<const Index>(counts).first(count), pairs_, found_);
}

}  // namespace skerry
