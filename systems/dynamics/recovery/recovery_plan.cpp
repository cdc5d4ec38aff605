#include "systems/dynamics/recovery/recovery_plan.h"

#include <algorithm>
#include <utility>

#include "systems/dynamics/recovery/node_patches.h"
#include "systems/dynamics/recovery/polynomial_fit.h"

namespace skerry {

namespace {

template <class T>
void append_row(Ragged<T>& list, std::span<const T> row) {
    if (list.offset.empty()) list.offset.push_back(0);
    for (const T& item : row) list.item.push_back(item);
    list.offset.push_back(static_cast<Index>(list.item.size()));
}

class Planner {
public:
    Planner(const RecoveryMesh& body, std::span<const Index> nodes)
        : body_(body),
          rest_(body.rest_position.begin(), body.rest_position.end()),
          patches_(body.tetrahedra, body.surface, body.material_of_tetrahedra, body.rest_position),
          smooth_(rest_.size(), no_index),
          near_(body.tetrahedra.size()) {
        turn_rest();
        for (const Index n : nodes) want(n);
        near_elements_ = ElementsNear(body.cover, near_);
        list_corners();
        plan_.nodes.assign(nodes.begin(), nodes.end());
        plan_.block = near_elements_.block;
        place_elements();
        for (std::size_t n = 0; n < rest_.size(); ++n)
            if (smooth_[n] != no_index) add_smooth(static_cast<Index>(n));
        for (const Index n : nodes) add_value(n);
    }

    RecoveryPlan take() { return std::move(plan_); }

private:
    /// Rotates the rest positions into the frame of the gradients. The gradients were rotated with the body when it was
    /// added. The elements have the inverse of this rotation as deformation gradient in the rest shape of the mesh.
    /// Elements that yield do not; they need no rotation, because fits do not depend on the frame.
    void turn_rest() {
        for (Index b = body_.blocks.begin; b < body_.blocks.end; ++b) {
            const auto block = static_cast<std::size_t>(b);
            if (!(body_.elements.volume[block][0] > 0) || body_.elements.material_of(block).yields()) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block);
            const auto rest = [&](Index k) -> const Vec3& {
                return body_.rest_position[static_cast<std::size_t>(nodes.node[k][0] - body_.first_node)];
            };
            Mat3 turn = Mat3::Zero();
            for (Index k = 1; k < nodes.count; ++k) {
                const ElementGradient& of = nodes.gradient[k];
                turn += Vec3(of[0][0], of[1][0], of[2][0]) * (rest(k) - rest(0)).transpose();
            }
            for (Vec3& x : rest_) x = turn * x;
            return;
        }
    }

    /// Marks the nodes and tetrahedra on which the value at a node depends.
    void want(Index n) {
        mark_around(n);
        if (patches_.kind(n) != NodeKind::other) return want_smooth(n);
        for (const Index material : patches_.materials_around(n))
            for (const Index donor : patches_.donors(n, material)) want_smooth(donor);
    }
    void want_smooth(Index n) {
        if (std::exchange(smooth_[static_cast<std::size_t>(n)], Index{0}) != no_index) return;
        mark_around(n);
        if (patches_.kind(n) == NodeKind::face)
            for (const Index inner : patches_.inner_neighbours(n)) mark_around(inner);
    }
    void mark_around(Index n) {
        for (const Index t : patches_.tetrahedra(n)) near_[static_cast<std::size_t>(t)] = 1;
    }

    std::size_t block_of(std::size_t place) const {
        return static_cast<std::size_t>(body_.blocks.begin + near_elements_.block[place / element_lanes]);
    }
    std::size_t place_count() const { return near_elements_.block.size() * element_lanes; }
    bool has_strain(Index place) const {
        return body_.elements.part[block_of(static_cast<std::size_t>(place))] != ElementPart::volume;
    }
    Vec3 rest(Index n) const { return rest_[static_cast<std::size_t>(n)]; }

    void place_elements() {
        plan_.center.assign(place_count(), Vec3::Zero());
        for (std::size_t place = 0; place < place_count(); ++place) {
            Real sum = 0;
            for (const Index t : near_elements_.covered(body_.cover, place)) {
                const Real share = patches_.volume(t);
                sum += share;
                for (const Index n : body_.tetrahedra[static_cast<std::size_t>(t)])
                    plan_.center[place] += share / 4 * rest(n);
            }
            if (sum > 0) plan_.center[place] /= sum;
        }
    }

    /// Numbers the nodes at which the force of the elements is needed, and lists the element corners at these nodes.
    /// All tetrahedra around these nodes are near, so the lists are complete.
    void list_corners() {
        force_row_.assign(rest_.size(), no_index);
        Index count = 0;
        const auto need = [&](Index n) {
            if (Index& row = force_row_[static_cast<std::size_t>(n)]; row == no_index) row = count++;
        };
        for (std::size_t n = 0; n < rest_.size(); ++n) {
            if (smooth_[n] == no_index || patches_.kind(static_cast<Index>(n)) != NodeKind::face) continue;
            need(static_cast<Index>(n));
            for (const Index inner : patches_.inner_neighbours(static_cast<Index>(n))) need(inner);
        }
        std::vector<std::vector<RecoveryPlan::Corner>> at(static_cast<std::size_t>(count));
        for (std::size_t place = 0; place < place_count(); ++place) {
            if (near_elements_.covered(body_.cover, place).empty()) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block_of(place));
            for (Index k = 0; k < nodes.count; ++k) {
                const Index n = nodes.node[k][place % element_lanes] - body_.first_node;
                if (const Index row = force_row_[static_cast<std::size_t>(n)]; row != no_index)
                    at[static_cast<std::size_t>(row)].push_back({static_cast<Index>(place), k});
            }
        }
        for (const std::vector<RecoveryPlan::Corner>& row : at) append_row<RecoveryPlan::Corner>(plan_.corners, row);
    }

    void add_smooth(Index n) {
        // A quadratic fit needs two samples or more per term. It is not used for stresses of single tetrahedra, which
        // scatter too much.
        constexpr std::size_t enough = 2 * quadratic_terms;
        smooth_[static_cast<std::size_t>(n)] = static_cast<Index>(plan_.smooth.size());
        std::vector<Index> strained, volumetric;
        Real size = 0;
        bool smoothed = false;
        const std::vector<Index> places = near_elements_.around(patches_.tetrahedra(n));
        for (const Index place : places) {
            const auto p = static_cast<std::size_t>(place);
            size = std::max(size, (plan_.center[p] - rest(n)).norm());
            (has_strain(place) ? strained : volumetric).push_back(place);
            smoothed = smoothed || (has_strain(place) && near_elements_.covered(body_.cover, p).size() > 1);
        }
        // The traction gives no elastic deformation gradient at the surface of a material that yields.
        const bool is_face = patches_.kind(n) == NodeKind::face &&
                             !body_.elements.material_of(block_of(static_cast<std::size_t>(places.front()))).yields();
        plan_.smooth.push_back({rest(n), size > 0 ? size : 1, smoothed && strained.size() >= enough,
                                is_face ? static_cast<Index>(plan_.faces.size()) : no_index});
        append_row<Index>(plan_.strained, strained);
        append_row<Index>(plan_.volumetric, volumetric);
        if (is_face) add_face(n, places.front());
    }

    void add_face(Index n, Index place) {
        std::vector<SurfaceTriangle> triangles;
        for (const Index t : patches_.triangles(n))
            if (const auto triangle = surface_triangle(body_.surface[static_cast<std::size_t>(t)], rest_))
                triangles.push_back(*triangle);
        append_row<SurfaceTriangle>(plan_.triangles, triangles);
        std::vector<Index> rows{force_row_[static_cast<std::size_t>(n)]};
        Real inner_volume = 0;
        for (const Index inner : patches_.inner_neighbours(n)) {
            rows.push_back(force_row_[static_cast<std::size_t>(inner)]);
            inner_volume += patches_.node_volume(inner);
        }
        append_row<Index>(plan_.force, rows);
        plan_.faces.push_back({surface_around(body_.surface, patches_.triangles(n), rest_), place,
                               inner_volume > 0 ? patches_.node_volume(n) / inner_volume : 0});
    }

    void add_value(Index n) {
        const auto begin = static_cast<Index>(plan_.extrapolations.size());
        const bool is_smooth = patches_.kind(n) != NodeKind::other;
        if (!is_smooth)
            for (const Index material : patches_.materials_around(n)) add_extrapolation(n, material);
        plan_.values.push_back({is_smooth ? smooth_[static_cast<std::size_t>(n)] : no_index,
                                {begin, static_cast<Index>(plan_.extrapolations.size())},
                                rest(n)});
    }

    void add_extrapolation(Index n, Index material) {
        const std::vector<Index> donors = patches_.donors(n, material);
        Real size = 0;
        for (const Index donor : donors) size = std::max(size, (rest(donor) - rest(n)).norm());
        if (!(size > 0)) size = 1;
        PolynomialFit<linear_terms, 1> fit;
        std::vector<Index> rows, strained, volumetric;
        for (const Index donor : donors) {
            fit.add(1, (rest(donor) - rest(n)) / size, decltype(fit)::Sample::Zero());
            rows.push_back(smooth_[static_cast<std::size_t>(donor)]);
        }
        int rank = 0;
        fit.at_origin(rank);
        const bool is_determined = rank == linear_terms;
        if (!is_determined)
            for (const Index place : near_elements_.around(patches_.tetrahedra(n)))
                if (patches_.material_of(
                        near_elements_.covered(body_.cover, static_cast<std::size_t>(place)).front()) == material)
                    (has_strain(place) ? strained : volumetric).push_back(place);
        append_row<Index>(plan_.donors, rows);
        append_row<Index>(plan_.strained_around, strained);
        append_row<Index>(plan_.volumetric_around, volumetric);
        plan_.extrapolations.push_back({patches_.node_volume(n, material), size, is_determined});
    }

    const RecoveryMesh& body_;
    std::vector<Vec3> rest_;  // m
    NodePatches patches_;
    std::vector<Index> smooth_;       // by node: row of RecoveryPlan::smooth; no_index if the node is not needed
    std::vector<std::uint8_t> near_;  // by tetrahedron: 1 if the elements that cover it are needed
    ElementsNear near_elements_;
    std::vector<Index> force_row_;  // by node: row of RecoveryPlan::corners, or no_index
    RecoveryPlan plan_;
};

}  // namespace

RecoveryPlan plan_recovery(const RecoveryMesh& body, std::span<const Index> nodes) {
    return Planner(body, nodes).take();
}

}  // namespace skerry
