#include <functional>
#include <limits>

#include "engine/base/complaint.h"
#include "engine/world/save/checks.h"
#include "systems/collision/colliders/collider_shape.h"
#include "systems/collision/inputs/contact_key.h"
#include "systems/collision/narrow/collider_distance.h"

namespace skerry {

namespace {

void expect_ascending(const SavedFile& file, const std::string& path, const auto& keys) {
    const auto at = std::ranges::adjacent_find(keys, std::greater_equal<>());
    if (at != keys.end())
        file.complain(path,
                      "a key that does not exceed the previous key, at row " + std::to_string(at - keys.begin() + 1),
                      "ascending keys");
}

/// Checks that a step length is positive. Denormal numbers are refused too, since steps treat them as zero.
void expect_step(const SavedFile& file, const std::string& path, Real step) {
    if (!(step >= std::numeric_limits<Real>::min())) file.complain(path, short_text(step), "a time > 0 (s)");
}

}  // namespace

void check_clock(const SavedFile& file, const Clock& clock, Real kick_time) {
    constexpr Real long_time = std::numeric_limits<Real>::max();
    expect_between(file, "clock/time", std::array{clock.time}, 0.0, long_time);
    expect_between(file, "clock/step_before", std::array{clock.step_before}, 0.0, long_time);
    expect_between(file, "last_step/kick", std::array{kick_time}, 0.0, long_time);
}

void check_cache(const SavedFile& file, const Model& model, ContactCache& cache) {
    const std::size_t bodies = model.bodies.slot.size(), colliders = model.colliders.slot.size();
    WarmStartTable& warm = cache.warm_start;
    expect_size(file, "warm_start/impulse", warm.impulse.size(), warm.key.size());
    expect_size(file, "warm_start/normal", warm.normal.size(), warm.key.size());
    if (!warm.point.empty()) expect_size(file, "warm_start/point", warm.point.size(), warm.key.size());
    if (warm.step.size() > 1)
        file.complain("warm_start/step", std::to_string(warm.step.size()) + " rows", "one row, or none");
    if (!warm.key.empty() && warm.step.empty())
        file.complain("warm_start/step", "no row", "one row, the step size of the warm-start impulses (s)");
    for (const Real step : warm.step) expect_step(file, "warm_start/step", step);
    expect_ascending(file, "warm_start/key", warm.key);

    PairTable& pairs = cache.pairs;
    const std::size_t count = pairs.size();
    expect_one_size(file, "pairs", pairs, count);
    expect_ascending(file, "pairs/key", pairs.key);
    expect_rows_of(file, "pairs/first", pairs.first, bodies);
    for (std::size_t p = 0; p < count; ++p) {
        if (model.bodies.kind[pairs.first[p]] != BodyKind::deformable)
            file.complain("pairs/first", at_row(pairs.first[p], p), "the index of a body that is not a mesh collider");
        const bool of_collider = pairs.kind[p] == PairKind::collider;
        const Index second = pairs.second[p];
        expect_rows_of(file, "pairs/second", {&second, 1}, of_collider ? colliders : bodies);
        if (of_collider && model.colliders.geometry[second].shape == ColliderShape::mesh)
            file.complain("pairs/second", at_row(second, p), "the index of a collider without a mesh");
        if (pairs.kind[p] == PairKind::self && second != pairs.first[p])
            file.complain("pairs/second", at_row(second, p),
                          "the same body as in pairs/first, because the pair is a self-contact");
    }

    const std::size_t origins = pairs.self.origin.size();
    const bool self_contact = std::ranges::find(pairs.kind, PairKind::self) != pairs.kind.end();
    if (origins != 0 || self_contact) expect_size(file, "pairs/self_origin", origins, model.nodes.position.size());

    // A column of the contact search has either one row per object or no rows. If it has no rows, the next step
    // searches all pairs.
    const SearchState& search = cache.search;
    const auto expect_all_or_none = [&](const char* path, std::size_t found, std::size_t expected) {
        if (found != 0) expect_size(file, path, found, expected);
    };
    expect_all_or_none("search/body_valid_until", search.body_valid_until.size(), bodies);
    expect_all_or_none("search/collider_valid_until", search.collider_valid_until.size(), colliders);
    expect_all_or_none("search/collider_extent", search.memory.collider_extent.size(), colliders);
    expect_all_or_none("search/rebase", search.memory.rebase.size(), bodies);
    if (search.collider_valid_until.size() == colliders && search.body_valid_until.size() == bodies)
        expect_size(file, "search/collider_extent", search.memory.collider_extent.size(), colliders);
}

bool inside(Index row, Range range) {
    return row >= range.begin && row < range.end;
}

/// True if a candidate (two features that may touch) consists of a feature of body `a` and a part or a point of a
/// collider.
bool is_of_collider(const Candidate& candidate, const BodyTable& bodies, Index a, ColliderShape shape) {
    const Index parts = collider_part_count(shape), second = second_local(candidate.feature);
    // An edge can have contacts_of_edge contacts with each part p, so its candidate has the second number
    // contacts_of_edge * p (edge_collider_feature).
    if (is_edge_edge(candidate.feature))
        return inside(candidate.first, bodies.edges[a]) && second < contacts_of_edge * parts &&
               second % contacts_of_edge == 0;
    if (is_face_collider(candidate.feature))
        return inside(candidate.first, bodies.triangles[a]) &&
               first_local(candidate.feature) < collider_point_count(shape);
    return inside(candidate.first, bodies.vertices[a]) && second < parts;
}

/// Throws SceneError unless the rows of LeafPairTable::listed are pairs of leaves of the body's bounding-volume tree.
/// The first row must be the pair of the root with itself, which stands for all pairs of leaves that are not listed.
/// Only self-contacts may have rows.
void check_leaf_pairs(const SavedFile& file, const Model& model, const PairTable& pairs, std::size_t p) {
    const Range tree = model.bodies.bvh_nodes[pairs.first[p]];
    const auto is_leaf = [&](Index row) {
        return row >= 0 && row < tree.size() && model.bvh.node[tree.begin + row].count > 0;
    };
    const auto& listed = pairs.leaf_pairs[p].listed;
    if (!listed.empty() && pairs.kind[p] != PairKind::self)
        file.complain("pairs/leaf_pairs", std::to_string(listed.size()) + " rows for pair " + std::to_string(p),
                      "no rows, because the pair is not a self-contact");
    for (std::size_t i = 0; i < listed.size(); ++i) {
        const auto& [first, second, spare] = listed[i];
        if (i == 0 ? first != 0 || second != 0 : !is_leaf(first) || !is_leaf(second))
            file.complain("pairs/leaf_pairs", "rows " + std::to_string(first) + " and " + std::to_string(second),
                          "leaves in the tree of the body; in the first row the root 0");
    }
}

void check_candidates(const SavedFile& file, const Model& model, const PairTable& pairs) {
    const BodyTable& bodies = model.bodies;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const Index a = pairs.first[p], b = pairs.second[p];
        for (const Candidate& candidate : pairs.candidates[p]) {
            bool good = false;
            if (pairs.kind[p] == PairKind::collider) {
                good = candidate.second == b && is_of_collider(candidate, bodies, a, model.colliders.geometry[b].shape);
            } else if (is_edge_edge(candidate.feature)) {
                good = inside(candidate.first, bodies.edges[a]) && inside(candidate.second, bodies.edges[b]);
            } else if (is_point_of_second(candidate.feature)) {
                good = inside(candidate.first, bodies.vertices[b]) && inside(candidate.second, bodies.triangles[a]);
            } else {
                good = inside(candidate.first, bodies.vertices[a]) && inside(candidate.second, bodies.triangles[b]);
            }
            if (!good)
                file.complain("pairs/candidates/first",
                              "features " + std::to_string(candidate.first) + " and " +
                                  std::to_string(candidate.second) + " of pair " + std::to_string(p),
                              "features of the two surfaces of this pair");
        }
        check_leaf_pairs(file, model, pairs, p);
    }
}

namespace {

void check_rows(const SavedFile& file, const Model& model, const std::string& group, ContactTable& contacts) {
    const std::size_t count = contacts.size();
    const AnyTable table(contacts);
    for (const ColumnInfo& info : table.columns())
        expect_size(file, group + info.name, table.column(info).size(), count);
    expect_rows_of(file, group + "first_body", contacts.first_body, model.bodies.slot.size());
    expect_rows_of(file, group + "second_body", contacts.second_body, model.bodies.slot.size(), true);
    expect_rows_of(file, group + "collider", contacts.collider, model.colliders.slot.size(), true);
    for (const Stencil& stencil : contacts.stencil)
        expect_rows_of(file, group + "stencil/node", stencil.node, model.nodes.position.size());
    for (const Index region : contacts.region)
        if (region < no_index)
            file.complain(group + "region", std::to_string(region), "the index of a region, or -1 for none");
}

}  // namespace

void check_contacts(const SavedFile& file, const Model& model, ContactTable& contacts) {
    check_rows(file, model, "last_step/contacts/", contacts);
}

void check_resting_contacts(const SavedFile& file, const Model& model, RestingContactTable& resting) {
    check_rows(file, model, "resting_contacts/", resting.contact);
    expect_size(file, "resting_contacts/step", resting.step.size(), resting.contact.size());
    for (const Real step : resting.step) expect_step(file, "resting_contacts/step", step);
    expect_ascending(file, "resting_contacts/key", resting.contact.key);
}

}  // namespace skerry
