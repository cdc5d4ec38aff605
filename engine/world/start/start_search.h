// Search for overlaps before the first step (docs/decisions/0017-start-overlaps.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/collision/overlap/collider_overlap.h"

namespace skerry {

/// A pair of objects that may overlap. The first object is a body. The second object is another body, the body of a
/// mesh collider, or an analytic collider.
struct StartPair {
    Index first;       // row of BodyTable; the kind of this body is `deformable`
    Index second;      // row of BodyTable; for an analytic collider, row of ColliderTable
    bool is_analytic;  // true: `second` is a row of ColliderTable

    auto operator<=>(const StartPair&) const = default;
};

struct PairOverlap {
    StartPair pair;
    Overlap overlap;
};

/// Finds overlaps in the present state of a world. The search can shift bodies by move(); the world itself does not
/// change.
class StartSearch {
public:
    /// `now`: present time [s], at which the motion scripts of colliders give their poses.
    StartSearch(const Model& model, Real now);

    /// Finds all overlapping pairs, sorted by table rows. A pair is skipped if earlier searches have checked both of
    /// its objects.
    std::vector<PairOverlap> find_all();
    /// Finds pairs of objects that may touch, because their bounding boxes overlap. At least one object of a pair must
    /// be marked, and at least one not checked by an earlier search. `marked`: for each row of BodyTable, nonzero if
    /// the body is marked.
    std::vector<StartPair> close_pairs(const std::vector<char>& marked) const;
    std::optional<Overlap> overlap_of(const StartPair& pair);

    void move(Index body, const Vec3& by) { shift_[static_cast<std::size_t>(body)] += by; }
    std::span<const Vec3> shifts() const { return shift_; }
    const Vec3& shift(Index body) const { return shift_[static_cast<std::size_t>(body)]; }
    /// Edge lengths of the bounding box of a body [m].
    Vec3 extent(Index body) const;
    /// Gap that remains between two objects after they are moved apart [m]: half the sum of their contact distances (0
    /// for an analytic collider), but at most a small fraction of the shorter mean edge length.
    Real margin(const StartPair& pair) const;
    /// True if a body has a closed surface or tetrahedra, and therefore a thickness. The thickness limits the depth of
    /// overlaps that can be resolved (MoveApart::deepest in settle_start.cpp).
    bool has_inside(Index body) { return solid(body).closed; }

private:
    Aabb box(Index body) const;
    bool is_settled(const StartPair& pair) const;
    bool collides(const StartPair& pair) const;
    const Solid& solid(Index body);
    Real mean_edge(const StartPair& pair) const;
    /// Upper bound of the error that rounding causes in the depth of an overlap [m]. If the depth is smaller, the
    /// objects may only touch.
    Real rounding(const StartPair& pair) const;
    /// Returns the shape of a spherical or capsule-shaped body at its shifted position; nullopt for all other bodies.
    std::optional<RoundSolid> round(Index body) const;
    std::optional<Overlap> overlap_of_bodies(const StartPair& pair);
    std::optional<Overlap> overlap_with_collider(const StartPair& pair);
    void add_analytic(const std::vector<char>& marked, const BoxTree& tree, std::vector<StartPair>& pairs) const;

    const Model& model_;
    std::vector<RigidMotion> collider_;  // poses of the colliders
    std::vector<Aabb> box_;              // bounding boxes of bodies before their shifts [m]
    std::vector<Vec3> shift_;
    std::vector<std::unique_ptr<Solid>> solid_;  // volume of each body; null until solid() builds it
};

}  // namespace skerry
