#include "systems/dynamics/recovery/recovery_plan.h"

#include <algorithm>
#include <iterator>
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
    using Term = RecoveryPlan::Term;

public:
    Planner(const RecoveryMesh& body, std::span<const Index> nodes)
        : body_(body),
          rest_(body.rest_position.begin(), body.rest_position.end()),
          patches_(body.tetrahedra, body.surface, body.material_of_tetrahedra, body.rest_position),
          smooth_(rest_.size(), no_index),
          needed_(body.tetrahedra.size()) {
        rotate_rest();
        for (const Index n : nodes) require(n);
        near_elements_ = ElementsNear(body.cover, needed_);
        list_corners();
        plan_.nodes.assign(nodes.begin(), nodes.end());
        plan_.block = near_elements_.block;
        find_centers();
        for (std::size_t n = 0; n < rest_.size(); ++n)
            if (smooth_[n] != no_index) add_smooth(static_cast<Index>(n));
        for (const Index n : nodes) add_value(n);
    }

    RecoveryPlan take() { return std::move(plan_); }

private:
    /// Rotates the rest positions X into the frame of the gradients g, which were rotated by R with the body when it
    /// was added. One element gives R, because every element has F = sum_k X_k g_k^T = R^T in the rest shape of the
    /// mesh. If all elements yield, no rotation is needed: fits do not depend on the frame.
    void rotate_rest() {
        for (Index b = body_.blocks.begin; b < body_.blocks.end; ++b) {
            const auto block = static_cast<std::size_t>(b);
            // Plastic flow has changed the gradients of elements that yield.
            if (!(body_.elements.volume[block][0] > 0) || body_.elements.material_of(block).yields()) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block);
            const auto rest = [&](Index k) -> const Vec3& {
                return body_.rest_position[static_cast<std::size_t>(nodes.node[k][0] - body_.first_node)];
            };
            Mat3 turn = Mat3::Zero();
            for (Index k = 1; k < nodes.count; ++k) {
                const ElementGradient& gradient = nodes.gradient[k];
                turn += Vec3(gradient[0][0], gradient[1][0], gradient[2][0]) * (rest(k) - rest(0)).transpose();
            }
            for (Vec3& x : rest_) x = turn * x;
            return;
        }
    }

    /// Marks the nodes and tetrahedra on which the value at a node depends: nodes in smooth_, tetrahedra in needed_.
    void require(Index n) {
        mark_around(n);
        if (patches_.kind(n) != NodeKind::other) return require_smooth(n);
        for (const Index material : patches_.materials_around(n))
            for (const Index donor : patches_.donors(n, material)) require_smooth(donor);
    }
    void require_smooth(Index n) {
        if (std::exchange(smooth_[static_cast<std::size_t>(n)], Index{0}) != no_index) return;
        mark_around(n);
        if (patches_.kind(n) == NodeKind::face)
            for (const Index inner : patches_.inner_neighbours(n)) mark_around(inner);
    }
    void mark_around(Index n) {
        for (const Index t : patches_.tetrahedra(n)) needed_[static_cast<std::size_t>(t)] = 1;
    }

    std::size_t block_of(std::size_t element) const {
        return static_cast<std::size_t>(body_.blocks.begin + near_elements_.block[element / element_lanes]);
    }
    std::size_t element_count() const { return near_elements_.block.size() * element_lanes; }
    bool has_strain(Index element) const {
        return body_.elements.part[block_of(static_cast<std::size_t>(element))] != ElementPart::volume;
    }
    Vec3 rest(Index n) const { return rest_[static_cast<std::size_t>(n)]; }

    void find_centers() {
        plan_.center.assign(element_count(), Vec3::Zero());
        for (std::size_t element = 0; element < element_count(); ++element) {
            Real sum = 0;
            for (const Index t : near_elements_.covered(body_.cover, element)) {
                const Real share = patches_.volume(t);
                sum += share;
                for (const Index n : body_.tetrahedra[static_cast<std::size_t>(t)])
                    plan_.center[element] += share / 4 * rest(n);
            }
            if (sum > 0) plan_.center[element] /= sum;
        }
    }

    /// Numbers the nodes at which the force of the elements is needed: nodes of smooth surfaces and their inner
    /// neighbours. Lists the element corners at these nodes. All tetrahedra around these nodes are marked in needed_,
    /// so no corner is missing.
    void list_corners() {
        force_row_.assign(rest_.size(), no_index);
        Index count = 0;
        const auto number = [&](Index n) {
            if (Index& row = force_row_[static_cast<std::size_t>(n)]; row == no_index) row = count++;
        };
        for (std::size_t n = 0; n < rest_.size(); ++n) {
            if (smooth_[n] == no_index || patches_.kind(static_cast<Index>(n)) != NodeKind::face) continue;
            number(static_cast<Index>(n));
            for (const Index inner : patches_.inner_neighbours(static_cast<Index>(n))) number(inner);
        }
        plan_.force_count = static_cast<std::size_t>(count);
        for (std::size_t element = 0; element < element_count(); ++element) {
            if (near_elements_.covered(body_.cover, element).empty()) continue;
            const BlockNodes nodes = body_.elements.nodes_of(block_of(element));
            for (Index k = 0; k < nodes.count; ++k) {
                const Index n = nodes.node[k][element % element_lanes] - body_.first_node;
                if (const Index row = force_row_[static_cast<std::size_t>(n)]; row != no_index)
                    plan_.corners.push_back({static_cast<Index>(element), k, row});
            }
        }
    }

    void add_smooth(Index n) {
        // A quadratic fit needs two samples or more per term. It is not used for stresses of single tetrahedra, which
        // scatter too much.
        constexpr std::size_t enough = 2 * quadratic_terms;
        smooth_[static_cast<std::size_t>(n)] = static_cast<Index>(plan_.face_of_smooth_node.size());
        std::vector<Index> strained, volumetric;
        bool smoothed = false;
        const std::vector<Index> elements = near_elements_.around(patches_.tetrahedra(n));
        for (const Index element : elements) {
            (has_strain(element) ? strained : volumetric).push_back(element);
            smoothed = smoothed || (has_strain(element) &&
                                    near_elements_.covered(body_.cover, static_cast<std::size_t>(element)).size() > 1);
        }
        // The traction does not determine F where the material yields, because the stress also depends on the plastic
        // strain.
        const bool is_face = patches_.kind(n) == NodeKind::face &&
                             !body_.elements.material_of(block_of(static_cast<std::size_t>(elements.front()))).yields();
        plan_.face_of_smooth_node.push_back(is_face ? static_cast<Index>(plan_.faces.size()) : no_index);
        if (is_face) {
            append_row<Term>(plan_.strained, mean_of(strained, 1));
            append_row<Term>(plan_.volumetric, mean_of(volumetric, 1));
            add_face(n, elements.front());
            return;
        }
        Real size = 0;
        for (const Index element : elements)
            size = std::max(size, (plan_.center[static_cast<std::size_t>(element)] - rest(n)).norm());
        if (!(size > 0)) size = 1;
        const bool is_quadratic = smoothed && strained.size() >= enough;
        append_row<Term>(plan_.strained, fit_of(is_quadratic, strained, rest(n), size));
        append_row<Term>(plan_.volumetric, fit_of(false, volumetric, rest(n), size));
    }

    Real volume(Index element) const {
        const auto p = static_cast<std::size_t>(element);
        return body_.elements.volume[block_of(p)][p % element_lanes];
    }

    /// For each element, factor of its value in the mean weighted by volume, times `share`.
    std::vector<Term> mean_of(std::span<const Index> elements, Real share) const {
        Real whole = 0;
        for (const Index element : elements) whole += volume(element);
        std::vector<Term> shares;
        if (whole > 0)
            for (const Index element : elements) shares.push_back({element, share * volume(element) / whole});
        return shares;
    }

    /// For each element, factor of its value in the value of a least-squares fit at the rest position `at`. The offsets
    /// of the element centres are divided by `size`.
    std::vector<Term> fit_of(bool is_quadratic, std::span<const Index> elements, const Vec3& at, Real size) const {
        std::vector<Vec3> offset;
        std::vector<Real> factor;
        for (const Index element : elements) {
            offset.emplace_back((plan_.center[static_cast<std::size_t>(element)] - at) / size);
            factor.push_back(volume(element));
        }
        if (is_quadratic)
            find_fit_factors<quadratic_terms>(offset, factor);
        else
            find_fit_factors<linear_terms>(offset, factor);
        std::vector<Term> shares;
        for (std::size_t i = 0; i < elements.size(); ++i) shares.push_back({elements[i], factor[i]});
        return shares;
    }

    void add_face(Index n, Index element) {
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
        append_row<Index>(plan_.force_rows, rows);
        plan_.faces.push_back({surface_around(body_.surface, patches_.triangles(n), rest_), element,
                               inner_volume > 0 ? patches_.node_volume(n) / inner_volume : 0});
    }

    void add_value(Index n) {
        const bool is_smooth = patches_.kind(n) != NodeKind::other;
        plan_.smooth_of.push_back(is_smooth ? smooth_[static_cast<std::size_t>(n)] : no_index);
        std::vector<Term> donors, strained, volumetric;
        if (!is_smooth) {
            const std::vector<Index> materials = patches_.materials_around(n);
            Real whole = 0;
            for (const Index material : materials) whole += patches_.node_volume(n, material);
            if (whole > 0)
                for (const Index material : materials)
                    extrapolate(n, material, patches_.node_volume(n, material) / whole, donors, strained, volumetric);
        }
        append_row<Term>(plan_.donors, donors);
        append_row<Term>(plan_.strained_around, strained);
        append_row<Term>(plan_.volumetric_around, volumetric);
    }

    /// Extrapolates to a node by a linear fit to the values of the donors of one material: appends the factors of these
    /// values, times `share`. If there are too few donors for a fit, appends the factors of the mean over the elements
    /// of this material around the node.
    void extrapolate(Index n, Index material, Real share, std::vector<Term>& donors, std::vector<Term>& strained,
                     std::vector<Term>& volumetric) {
        const std::vector<Index> nodes = patches_.donors(n, material);
        Real size = 0;
        for (const Index donor : nodes) size = std::max(size, (rest(donor) - rest(n)).norm());
        if (!(size > 0)) size = 1;
        std::vector<Vec3> offset;
        for (const Index donor : nodes) offset.emplace_back((rest(donor) - rest(n)) / size);
        std::vector<Real> factor(nodes.size(), 1);
        if (find_fit_factors<linear_terms>(offset, factor) == linear_terms) {
            for (std::size_t i = 0; i < nodes.size(); ++i)
                donors.push_back({smooth_[static_cast<std::size_t>(nodes[i])], share * factor[i]});
            return;
        }
        std::vector<Index> strained_elements, volumetric_elements;
        for (const Index element : near_elements_.around(patches_.tetrahedra(n)))
            if (patches_.material_of(near_elements_.covered(body_.cover, static_cast<std::size_t>(element)).front()) ==
                material)
                (has_strain(element) ? strained_elements : volumetric_elements).push_back(element);
        std::ranges::copy(mean_of(strained_elements, share), std::back_inserter(strained));
        std::ranges::copy(mean_of(volumetric_elements, share), std::back_inserter(volumetric));
    }

    const RecoveryMesh& body_;
    std::vector<Vec3> rest_;  // m
    NodePatches patches_;
    // by node: its row of RecoveryPlan::face_of_smooth_node, or no_index if this row is not needed; 0 until add_smooth
    // sets the row
    std::vector<Index> smooth_;
    std::vector<std::uint8_t> needed_;  // by tetrahedron: 1 if the elements that cover it are needed
    ElementsNear near_elements_;
    std::vector<Index> force_row_;  // by node: its row among the nodes whose force is needed, or no_index
    RecoveryPlan plan_;
};

}  // namespace

RecoveryPlan plan_recovery(const RecoveryMesh& body, std::span<const Index> nodes) {
    return Planner(body, nodes).take();
}

}  // namespace skerry
