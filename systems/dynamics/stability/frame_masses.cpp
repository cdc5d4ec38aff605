// Divides the masses of nodes among elements in proportion to a stiffness at rest (docs/methods/stable_step.md 2.4).
//
// Element e gets the mass K_e / c. Its stiffness K_e is computed with H X = 2 mu X + lambda tr(X) I, an upper bound on
// dP/dF at rest that, unlike the material law, resists rotations. The masses add up to no more than the mass M of the
// nodes if c is above the highest eigenvalue of M^-1/2 (sum_e K_e) M^-1/2.
//
// The highest modes of a mesh rotate little, so the highest frequency with H is within a few per cent of the true one.
#include "systems/dynamics/stability/frame_masses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "components/check.h"
#include "components/lanes.h"
#include "components/split_mix.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/mass_search.h"

namespace skerry {

namespace {

// Estimated ratio of two stable steps of a body: the step with frame masses, and the shorter step by the frequencies
// that elements have alone (see RestModuli). It decides how much the springs of viscoelastic materials relax in a step.
constexpr Real longer_in_frame = 2;

// The sum is written out term by term, so that the bits do not depend on how a library vectorises it.
Real product_of(const auto& a, const auto& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Matrix M^-1/2 K M^-1/2 of a body at rest, with the mass M of the nodes and the sum K of the stiffnesses K_e (head of
/// the file). Row 3 n + i belongs to component i of node n. Nodes are numbered by position along the longest side of
/// the body.
class RestStiffness {
public:
    RestStiffness(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                  std::span<const Real> mass)
        : elements_(elements), blocks_(blocks), moduli_(elements, blocks, longer_in_frame) {
        Index last = 0;
        first_node_ = std::numeric_limits<Index>::max();
        for_each_node([&](Index node) {
            first_node_ = std::min(first_node_, node);
            last = std::max(last, node);
        });
        const auto count = static_cast<std::size_t>(last + 1 - first_node_);
        weigh();
        number(position.subspan(static_cast<std::size_t>(first_node_), count));
        inverse_root_mass_.resize(count);
        for (std::size_t n = 0; n < count; ++n) {
            const Real node_mass = mass[static_cast<std::size_t>(first_node_) + n];
            inverse_root_mass_[n] = node_mass > 0 ? 1 / std::sqrt(node_mass) : 0;
        }
    }

    /// Number of multiplications in a Cholesky decomposition of the matrix.
    Real products() const {
        const auto size = static_cast<Real>(3 * nodes_), width = static_cast<Real>(3 * width_);
        return size * width * width / 2;
    }

    /// Lower bound on the highest eigenvalue of the matrix, by the method of Lanczos (1950) [1/s^2].
    Real highest() const {
        constexpr int most_products = 40;
        SplitMix noise(1);
        const Factors factors = factors_of_elements();
        std::vector<Real4> before(inverse_root_mass_.size(), Real4{}), vector(inverse_root_mass_.size(), Real4{}),
            product(inverse_root_mass_.size());
        Real size = 0;
        for (std::size_t n = 0; n < vector.size(); ++n) {
            for (int i = 0; i < 3; ++i) vector[n][i] = inverse_root_mass_[n] > 0 ? noise.symmetric() : 0;
            size += product_of(vector[n], vector[n]);
        }
        if (!(size > 0)) return 0;
        size = std::sqrt(size);
        for (Real4& x : vector) x /= size;
        std::vector<Real> diagonal, beside;
        for (int step = 0; step < most_products; ++step) {
            multiply(factors, vector, product);
            Real along = 0;
            for (std::size_t n = 0; n < vector.size(); ++n) along += product_of(vector[n], product[n]);
            diagonal.push_back(along);
            const Real last = beside.empty() ? 0 : beside.back();
            Real rest = 0;
            for (std::size_t n = 0; n < vector.size(); ++n) {
                product[n] -= along * vector[n] + last * before[n];
                rest += product_of(product[n], product[n]);
            }
            rest = std::sqrt(rest);
            if (!(rest > 1e-9 * diagonal[0])) break;
            beside.push_back(rest);
            std::swap(before, vector);
            for (std::size_t n = 0; n < vector.size(); ++n) vector[n] = product[n] / rest;
        }
        return highest_of(diagonal, beside);
    }

    /// True if all eigenvalues of the matrix are below `limit` [1/s^2].
    bool is_below(Real limit, BandDecomposition& decomposition) const {
        const auto add_rows = [&](std::size_t node, Real* rows, std::size_t stride) { add(node, rows, stride); };
        return decomposition.is_below({3 * nodes_, 3 * width_, 3, add_rows}, limit);
    }

    /// Computes the entries q and b of all frame masses (frame_masses.h). `bound`: upper bound on the eigenvalues of
    /// M^-1/2 K M^-1/2 [1/s^2].
    void share(Real bound, std::span<FrameMass> mass) const {
        for (std::size_t i = 0; i < mass.size(); ++i) {
            const std::size_t block = static_cast<std::size_t>(blocks_.begin) + i;
            const auto [shear, volumetric] = moduli_.moduli(block);
            const Real8 volume = load(elements_.volume[block]), explicit_volume = moduli_.explicit_mask(block) * volume;
            const Real8 one = Real8{} + 1.0, none = Real8{} + form_of_implicit;
            const Real8 stiffness = explicit_volume > 0.0 ? Real8(volume * shear) : one;
            store(Real8(explicit_volume > 0.0 ? Real8(bound / stiffness) : volume > 0.0 ? none : Real8{}), mass[i][0]);
            store(Real8(explicit_volume > 0.0 ? Real8(volume * volumetric / bound) : Real8{}), mass[i][1]);
        }
    }

private:
    /// Rest volume [m^3] and moduli times volume [Pa m^3] of the elements of a block; 0 for elements that get no mass.
    struct Weights {
        ElementLane volume, shear, volumetric;
    };
    struct Element {
        const BlockNodes& nodes;
        std::size_t lane;
        Index count, first_node;
        Real shear, volumetric;  // moduli times volume [Pa m^3]
        std::size_t node(Index k) const { return static_cast<std::size_t>(nodes.node[k][lane] - first_node); }
        Vec3 gradient(Index k) const {
            const ElementGradient& g = nodes.gradient[k];
            return {g[0][lane], g[1][lane], g[2][lane]};
        }
    };

    /// Adds the matrix entries of one node to its three rows, which are zero so far. `place`: number of the node by
    /// position along the body. Each row is stored from its diagonal on, `stride` numbers after the previous row.
    void add(std::size_t place, Real* rows, std::size_t stride) const {
        for (const ElementCorner& corner : corners_[place]) {
            const BlockNodes nodes = elements_.nodes_of(corner.block);
            const Element e = element_of(nodes, corner.block, corner.lane);
            const Vec3 g = inverse_root_mass_[e.node(corner.corner)] * e.gradient(corner.corner);
            for (Index j = 0; j < e.count; ++j) {
                const std::size_t other_node = number_of_node_[e.node(j)];
                if (other_node < place) continue;
                const std::size_t column = 3 * (other_node - place);
                const Vec3 other = inverse_root_mass_[e.node(j)] * e.gradient(j);
                const Real same = e.shear * product_of(g, other);
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t l = column == 0 ? i : 0; l < 3; ++l)
                        rows[i * stride + (column + l - i)] +=
                            e.volumetric * g[static_cast<Eigen::Index>(i)] * other[static_cast<Eigen::Index>(l)] +
                            (i == l ? same : 0);
            }
        }
    }

    void for_each_node(auto&& visit) const {
        for (auto b = static_cast<std::size_t>(blocks_.begin); b < static_cast<std::size_t>(blocks_.end); ++b) {
            const BlockNodes nodes = elements_.nodes_of(b);
            for (Index k = 0; k < nodes.count; ++k)
                for (const Index node : nodes.node[k].lane) visit(node);
        }
    }
    Element element_of(const BlockNodes& nodes, std::size_t block, std::size_t lane) const {
        const Weights& of_block = weights_[block - static_cast<std::size_t>(blocks_.begin)];
        return {nodes, lane, nodes.count, first_node_, of_block.shear[lane], of_block.volumetric[lane]};
    }
    /// Calls visit(element, block) for each element with a mass share.
    void for_each_element(auto&& visit) const {
        for (auto b = static_cast<std::size_t>(blocks_.begin); b < static_cast<std::size_t>(blocks_.end); ++b) {
            const BlockNodes nodes = elements_.nodes_of(b);
            const ElementLane& volume = weights_[b - static_cast<std::size_t>(blocks_.begin)].volume;
            for (std::size_t l = 0; l < element_lanes; ++l)
                if (volume[l] > 0) visit(element_of(nodes, b, l), b);
        }
    }
    void weigh() {
        weights_.resize(static_cast<std::size_t>(blocks_.size()));
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            const std::size_t block = static_cast<std::size_t>(blocks_.begin) + i;
            const auto [shear, volumetric] = moduli_.moduli(block);
            const Real8 volume = moduli_.explicit_mask(block) * load(elements_.volume[block]);
            store(volume, weights_[i].volume);
            store(Real8(volume * shear), weights_[i].shear);
            store(Real8(volume * volumetric), weights_[i].volumetric);
        }
    }

    /// Numbers the nodes by position along the body. Finds the bandwidth: the greatest difference between the numbers
    /// of two nodes of one element, plus 1.
    void number(std::span<const Vec3> position) {
        std::vector<char> seen(position.size(), 0);
        std::vector<Index> nodes;
        for_each_node([&](Index node) {
            char& known = seen[static_cast<std::size_t>(node - first_node_)];
            if (!known) nodes.push_back(node - first_node_);
            known = 1;
        });
        sort_along(position, nodes);
        nodes_ = nodes.size();
        number_of_node_.resize(position.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) number_of_node_[static_cast<std::size_t>(nodes[i])] = i;
        for_each_element([&](const Element& e, std::size_t) {
            std::size_t low = number_of_node_[e.node(0)], high = low;
            for (Index k = 1; k < e.count; ++k) {
                low = std::min(low, number_of_node_[e.node(k)]);
                high = std::max(high, number_of_node_[e.node(k)]);
            }
            width_ = std::max(width_, high - low + 1);
        });
        corners_ = corners_at(nodes_, [&](auto&& visit) {
            for_each_element([&](const Element& e, std::size_t block) {
                for (Index k = 0; k < e.count; ++k) visit(number_of_node_[e.node(k)], ElementCorner{block, e.lane, k});
            });
        });
    }

    /// Data for products of the matrix with a vector: the elements that get mass, and their corners.
    struct Factors {
        struct Element {
            Real shear, volumetric;
            std::size_t end;  // end of the range of the element's corners in `corner`
        };
        struct Corner {
            Real4 gradient;  // gradient divided by the square root of the node's mass; a zero pads the register
            std::size_t node;
        };
        std::vector<Element> element;
        std::vector<Corner> corner;
    };
    Factors factors_of_elements() const {
        Factors factors;
        for_each_element([&](const Element& e, std::size_t) {
            for (Index k = 0; k < e.count; ++k) {
                const Vec3 g = inverse_root_mass_[e.node(k)] * e.gradient(k);
                factors.corner.push_back({Real4{g[0], g[1], g[2], 0}, e.node(k)});
            }
            factors.element.push_back({e.shear, e.volumetric, factors.corner.size()});
        });
        return factors;
    }

    /// Computes product = M^-1/2 K M^-1/2 vector.
    static void multiply(const Factors& factors, const std::vector<Real4>& vector, std::vector<Real4>& product) {
        std::ranges::fill(product, Real4{});
        std::size_t first = 0;
        for (const Factors::Element& e : factors.element) {
            const std::span<const Factors::Corner> corners = std::span(factors.corner).subspan(first, e.end - first);
            first = e.end;
            std::array<Real4, 3> slope{};  // gradient of `vector` in the element, by direction
            for (const Factors::Corner& corner : corners)
                for (int i = 0; i < 3; ++i)
                    slope[static_cast<std::size_t>(i)] += corner.gradient[i] * vector[corner.node];
            const Real pressure = e.volumetric * (slope[0][0] + slope[1][1] + slope[2][2]);
            for (const Factors::Corner& corner : corners) {
                const Real4& g = corner.gradient;
                product[corner.node] += e.shear * (slope[0] * g[0] + slope[1] * g[1] + slope[2] * g[2]) + pressure * g;
            }
        }
    }

    /// Highest eigenvalue of a symmetric tridiagonal matrix T with the diagonal `diagonal` and the off-diagonal
    /// `beside`. A number x is above all eigenvalues if the elimination of x - T has positive pivots only (Sturm).
    static Real highest_of(const std::vector<Real>& diagonal, const std::vector<Real>& beside) {
        const auto is_above = [&](Real x) {
            Real pivot = x - diagonal[0];
            for (std::size_t i = 1; i < diagonal.size() && pivot > 0; ++i)
                pivot = x - diagonal[i] - beside[i - 1] * beside[i - 1] / pivot;
            return pivot > 0;
        };
        Real low = *std::ranges::max_element(diagonal), high = low;
        for (const Real b : beside) high = std::max(high, low + 2 * b);
        constexpr int halvings = 40;
        for (int i = 0; i < halvings; ++i) {
            const Real middle = (low + high) / 2;
            (is_above(middle) ? high : low) = middle;
        }
        return low;
    }

    const ElementInputs& elements_;
    Range blocks_;
    RestModuli moduli_;
    Index first_node_ = 0;
    // Inverse square root of the mass by node, beginning with the first node of the body [1/sqrt(kg)].
    std::vector<Real> inverse_root_mass_;
    std::vector<std::size_t> number_of_node_;
    std::size_t nodes_ = 0, width_ = 0;
    std::vector<Weights> weights_;   // by block
    Ragged<ElementCorner> corners_;  // by number of the node along the body
};

}  // namespace

void find_frame_masses(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                       std::span<const Real> mass, Real most_products, std::span<FrameMass> frame_mass,
                       std::span<Real> bound) {
    SKERRY_CHECK(frame_mass.size() == static_cast<std::size_t>(blocks.size()) && bound.size() == frame_mass.size());
    std::ranges::fill(frame_mass, FrameMass{});
    std::ranges::fill(bound, Real{0});
    if (blocks.size() == 0) return;
    const RestStiffness stiffness(elements, blocks, position, mass);
    if (!(stiffness.products() <= most_products)) return;
    constexpr Real above = 1.005;  // ratio of the first limit to the Lanczos value, which may be slightly too low
    BandDecomposition decomposition;
    Real limit = above * stiffness.highest();
    for (Real growth = above; std::isfinite(limit) && limit > 0 && !stiffness.is_below(limit, decomposition);
         growth *= growth)
        limit *= growth;
    if (!(limit > 0) || !std::isfinite(limit)) return;
    stiffness.share(limit, frame_mass);
    std::ranges::fill(bound, limit);
}

}  // namespace skerry
