// Search for overlaps before the first step (docs/decisions/0017-start-overlaps.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/collision/overlap/collider_overlap.h"

namespace skerry {

/// A pair to search: a body, and a second body, the body of a mesh collider or an analytic collider.
struct StartPair {
    Index first;       // row of BodyTable with the kind `deformable`
    Index second;      // row of BodyTable; for an analytic collider, row of ColliderTable
    bool is_analytic;  // `second` is a row of ColliderTable

    auto operator<=>(const StartPair&) const = default;
};

struct PairOverlap {
    StartPair pair;
    Overlap overlap;
};

/// Finds overlaps in the present state of a world, with bodies shifted by move(). The world itself does not change.
class StartSearch {
public:
    /// `now`: present time, for which scripts give the poses of colliders [s].
    StartSearch(const Model& model, Real now);

    /// Finds all overlapping pairs, sorted by their rows. Pairs of two objects that an earlier search has checked are
    /// skipped.
    std::vector<PairOverlap> find_all();
    /// Finds pairs whose bounding boxes overlap. At least one object of a pair must be marked, and at least one must
    /// not have been checked by an earlier search. `marked`: by row of BodyTable.
    std::vector<StartPair> close_pairs(const std::vector<char>& marked) const;
    std::optional<Overlap> look_at(const StartPair& pair);

    void move(Index body, const Vec3& by) { shift_[static_cast<std::size_t>(body)] += by; }
    std::span<const Vec3> shifts() const { return shift_; }
    const Vec3& shift(Index body) const { return shift_[static_cast<std::size_t>(body)]; }
    /// Edge lengths of the bounding box of a body [m].
    Vec3 extent(Index body) const;
    /// Gap that remains between the two objects of a pair that is moved apart: their contact distance, but at most a
    /// fraction of the mean edge length [m].
    Real margin(const StartPair& pair) const;
    /// True if a body has a closed surface or tetrahedra. Another body pushed half through it may come out on the wrong
    /// side.
    bool has_inside(Index body) { return solid(body).closed; }

private:
    Aabb box(Index body) const;
    bool is_settled(const StartPair& pair) const;
    bool collides(const StartPair& pair) const;
    const Solid& solid(Index body);
    Real mean_edge(const StartPair& pair) const;
    /// Depth below which an overlap cannot be distinguished from contact, because of rounding [m].
    Real rounding(const StartPair& pair) const;
    /// The shape of a sphere or capsule at its shifted position; nullopt for all other bodies.
    std::optional<RoundSolid> round(Index body) const;
    std::optional<Overlap> look_at_bodies(const StartPair& pair);
    std::optional<Overlap> look_at_collider(const StartPair& pair);
    void add_analytic(const std::vector<char>& marked, const BoxTree& tree, std::vector<StartPair>& pairs) const;

    const Model& model_;
    std::vector<RigidMotion> collider_;  // their poses
    std::vector<Aabb> box_;              // bounding boxes of bodies before their shifts [m]
    std::vector<Vec3> shift_;
    std::vector<std::unique_ptr<Solid>> solid_;  // by body; null until the body is searched
};

}  // namespace skerry
