// Who overlaps whom before anything moves (docs/decisions/0017-start-overlaps.md).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/world/state/model.h"
#include "systems/collision/overlap/collider_overlap.h"

namespace skerry {

/// A body with another, with that of a mesh collider, or with an analytic collider.
struct StartPair {
    Index first;       // row of BodyTable, deformable
    Index second;      // row of BodyTable, or of ColliderTable
    bool is_analytic;  // it is of the latter

    auto operator<=>(const StartPair&) const = default;
};

struct PairOverlap {
    StartPair pair;
    Overlap overlap;
};

/// Looks at a world as it is, with bodies moved as a whole by what `move` says; the world stays as it is.
class StartSearch {
public:
    /// Colliders are where their motion has them at `now` (s).
    StartSearch(const Model& model, Real now);

    /// All pairs that overlap and of which one is not settled, in the order of their rows.
    std::vector<PairOverlap> find_all();
    /// Pairs whose boxes overlap, of which one is not settled and one is marked (by row of BodyTable).
    std::vector<StartPair> close_pairs(const std::vector<char>& marked) const;
    std::optional<Overlap> look_at(const StartPair& pair);

    void move(Index body, const Vec3& by) { shift_[static_cast<std::size_t>(body)] += by; }
    std::span<const Vec3> shifts() const { return shift_; }
    const Vec3& shift(Index body) const { return shift_[static_cast<std::size_t>(body)]; }
    /// m, of the box of a body.
    Vec3 extent(Index body) const;
    /// m: what is left free between two that are moved apart: their contact distance, if it is not out of proportion.
    Real margin(const StartPair& pair) const;
    /// A closed surface or tetrahedra: what is pushed half through it may as well come out on the other side.
    bool has_inside(Index body) { return solid(body).closed; }

private:
    Aabb box(Index body) const;
    bool is_settled(const StartPair& pair) const;
    bool collides(const StartPair& pair) const;
    const Solid& solid(Index body);
    Real mean_edge(const StartPair& pair) const;
    /// m: two that are in each other by less cannot be told from two that touch.
    Real rounding(const StartPair& pair) const;
    /// Where it has been moved, if it is one.
    std::optional<RoundSolid> round(Index body) const;
    std::optional<Overlap> look_at_bodies(const StartPair& pair);
    std::optional<Overlap> look_at_collider(const StartPair& pair);
    void add_analytic(const std::vector<char>& marked, const BoxTree& tree, std::vector<StartPair>& pairs) const;

    const Model& model_;
    std::vector<RigidMotion> collider_;  // where it is
    std::vector<Aabb> box_;              // of bodies, before they are moved
    std::vector<Vec3> shift_;
    std::vector<std::unique_ptr<Solid>> solid_;  // of those that were looked at
};

}  // namespace skerry
