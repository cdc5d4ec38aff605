// Search for overlaps before anything moves (docs/decisions/0017-start-overlaps.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/collision/overlap/collider_overlap.h"

namespace skerry {

/// A body with another body, with the body of a mesh collider, or with an analytic collider.
struct StartPair {
    Index first;       // row of BodyTable, deformable
    Index second;      // row of BodyTable, or of ColliderTable
    bool is_analytic;  // `second` is a row of ColliderTable

    auto operator<=>(const StartPair&) const = default;
};

struct PairOverlap {
    StartPair pair;
    Overlap overlap;
};

/// Searches a world in its present state, with bodies shifted by `move`; the world stays as it is.
class StartSearch {
public:
    /// Colliders are at the poses that their motion gives for `now` [s].
    StartSearch(const Model& model, Real now);

    /// All overlapping pairs with at least one partner that is not settled, in the order of their rows.
    std::vector<PairOverlap> find_all();
    /// Pairs whose boxes overlap, with a partner that is not settled and one that is marked (by row of BodyTable).
    std::vector<StartPair> close_pairs(const std::vector<char>& marked) const;
    std::optional<Overlap> look_at(const StartPair& pair);

    void move(Index body, const Vec3& by) { shift_[static_cast<std::size_t>(body)] += by; }
    std::span<const Vec3> shifts() const { return shift_; }
    const Vec3& shift(Index body) const { return shift_[static_cast<std::size_t>(body)]; }
    /// Extent of the box of a body [m].
    Vec3 extent(Index body) const;
    /// Gap left between two bodies that are moved apart: their contact distance, unless that is disproportionate [m].
    Real margin(const StartPair& pair) const;
    /// Whether it has a closed surface or tetrahedra. A body pushed half through it may come out on the other side.
    bool has_inside(Index body) { return solid(body).closed; }

private:
    Aabb box(Index body) const;
    bool is_settled(const StartPair& pair) const;
    bool collides(const StartPair& pair) const;
    const Solid& solid(Index body);
    Real mean_edge(const StartPair& pair) const;
    /// Depth below which an overlap cannot be told from contact [m].
    Real rounding(const StartPair& pair) const;
    /// The body at its shifted place if it is a sphere or capsule.
    std::optional<RoundSolid> round(Index body) const;
    std::optional<Overlap> look_at_bodies(const StartPair& pair);
    std::optional<Overlap> look_at_collider(const StartPair& pair);
    void add_analytic(const std::vector<char>& marked, const BoxTree& tree, std::vector<StartPair>& pairs) const;

    const Model& model_;
    std::vector<RigidMotion> collider_;  // their poses
    std::vector<Aabb> box_;              // of bodies, before their shifts
    std::vector<Vec3> shift_;
    std::vector<std::unique_ptr<Solid>> solid_;  // of bodies that were checked so far
};

}  // namespace skerry
