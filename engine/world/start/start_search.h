// Search for overlaps before the first step (docs/decisions/0017-start-overlaps.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/collision/overlap/collider_overlap.h"

namespace skerry {

/// A pair of objects to search for overlaps. The first object is a body. The second object is another body, the body of
/// a mesh collider, or an analytic collider.
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
    /// `now`: present time [s], at which scripts are evaluated to get the poses of colliders.
    StartSearch(const Model& model, Real now);

    /// Finds all overlapping pairs, sorted by table rows. Pairs of two objects that an earlier search has checked are
    /// skipped.
    std::vector<PairOverlap> find_all();
    /// Finds pairs of objects whose bounding boxes overlap. At least one object of a pair must be marked, and at least
    /// one must not have been checked by an earlier search. `marked`: for each row of BodyTable, nonzero if the body is
    /// marked.
    std::vector<StartPair> close_pairs(const std::vector<char>& marked) const;
    std::optional<Overlap> overlap_of(const StartPair& pair);

    void move(Index body, const Vec3& by) { shift_[static_cast<std::size_t>(body)] += by; }
    std::span<const Vec3> shifts() const { return shift_; }
    const Vec3& shift(Index body) const { return shift_[static_cast<std::size_t>(body)]; }
    /// Edge lengths of the bounding box of a body [m].
    Vec3 extent(Index body) const;
    /// Gap that remains between two objects after they are moved apart [m]: half the sum of their contact distances (0
    /// for an analytic collider), but at most a fraction of the mean edge length.
    Real margin(const StartPair& pair) const;
    /// True if a body has a closed surface or tetrahedra, and therefore a thickness. A body that overlaps it by more
    /// than half of the thickness may be moved out on the wrong side.
    bool has_inside(Index body) { return solid(body).closed; }

private:
    Aabb box(Index body) const;
    bool is_settled(const StartPair& pair) const;
    bool collides(const StartPair& pair) const;
    const Solid& solid(Index body);
    Real mean_edge(const StartPair& pair) const;
    /// Depth below which rounding makes an overlap indistinguishable from contact [m].
    Real rounding(const StartPair& pair) const;
    /// Returns the shape of a sphere or capsule at its shifted position, or nullopt for all other bodies.
    std::optional<RoundSolid> round(Index body) const;
    std::optional<Overlap> overlap_of_bodies(const StartPair& pair);
    std::optional<Overlap> overlap_with_collider(const StartPair& pair);
    void add_analytic(const std::vector<char>& marked, const BoxTree& tree, std::vector<StartPair>& pairs) const;

    const Model& model_;
    std::vector<RigidMotion> collider_;  // poses of the colliders
    std::vector<Aabb> box_;              // bounding boxes of bodies before their shifts [m]
    std::vector<Vec3> shift_;
    std::vector<std::unique_ptr<Solid>> solid_;  // surfaces by body; null until solid() builds them
};

}  // namespace skerry
