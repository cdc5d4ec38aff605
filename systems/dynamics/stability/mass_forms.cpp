// Chooses the matrix Q of the mass form G Q^-1 G^T of each element (docs/methods/stable_step.md 2.3). This form is the
// part of the nodal masses that the element gets. Row k of G is the gradient of the shape function of node k at rest. V
// is the volume of the element.
//
// Let W be the matrix 2 mu I + lambda tr(Z) Z^-1, with Lame's mu and lambda and any positive definite matrix Z. Then
// V G W G^T bounds the stiffness of the element at rest. Q is proportional to (V W)^-1. A good Z is the square root of
// the mean of grad u grad u^T over the highest modes u. Rounds of iteration find Z and these modes together.
//
// The bound is the same for x, y and z, so the matrix that adds it up over all elements is a third as wide as the true
// stiffness matrix. The eigenvalues of this matrix are sharper bounds than those of single elements.
#include "systems/dynamics/stability/mass_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "components/check.h"
#include "components/split_mix.h"
#include "systems/dynamics/stability/mass_search.h"
#include "systems/dynamics/stability/without_guards.h"
#include "systems/material/relaxation.h"

namespace skerry {

namespace {

using Symmetric = LaneSymmetric<Real8>;

void store_form(const Symmetric& s, ElementForm& form) {
    const Real8 entry[6] = {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx};
    for (std::size_t i = 0; i < 6; ++i) store(entry[i], form[i]);
}

Symmetric mean_of(const Symmetric& a, const Symmetric& b, Real part_of_b) {
    const auto mean = [=](const Real8& x, const Real8& y) { return (1 - part_of_b) * x + part_of_b * y; };
    return {mean(a.xx, b.xx), mean(a.yy, b.yy), mean(a.zz, b.zz), mean(a.xy, b.xy), mean(a.yz, b.yz), mean(a.zx, b.zx)};
}

/// Approximate square root of a positive definite matrix of trace 1 (Denman and Beavers 1976). Eigenvalues of the root
/// below 0.03 are not exact: they come out too large.
Symmetric root_of(const Symmetric& s) {
    constexpr int passes = 6;
    Symmetric root = s, inverse{Real8{} + 1.0, Real8{} + 1.0, Real8{} + 1.0, {}, {}, {}};
    for (int pass = 0; pass < passes; ++pass) {
        const Symmetric next = mean_of(root, inverse_of(inverse), 0.5);
        inverse = mean_of(inverse, inverse_of(root), 0.5);
        root = next;
    }
    return root;
}

Real4 noise_of(SplitMix& random) {
    const Real x = random.symmetric(), y = random.symmetric(), z = random.symmetric(), w = random.symmetric();
    return Real4{x, y, z, w};
}

Real sum_of(const Real4& x) {
    return (x[0] + x[1]) + (x[2] + x[3]);
}

// Estimated ratio of two stable steps of a body: the step with mass forms, and the shorter step by the frequencies that
// elements have alone (see RestModuli). It decides how much the springs of viscoelastic materials relax in a step.
constexpr Real longer_by_forms = 1.5;

// Number of blocks of elements above which a body counts as large and gets only one round of iteration. Its step is
// determined by the modes between its many groups. With 16 rounds instead of one, the steps of three meshes of 280,000
// to 310,000 tetrahedra changed by 0 %, 4 % and -2 %.
constexpr std::size_t blocks_of_large = 30'000;

/// Group of elements. The group's share of the mass of its nodes is divided among the elements of this group alone.
struct ElementGroup {
    Range blocks;
    // Nodes sorted along the longest side of the group, counted from the first node of the body.
    std::vector<Index> node{};
    // bandwidth: 1 + greatest difference of the indices in `node` of two nodes of an element
    std::size_t width = 0;
    std::vector<Real> mass{};  // share of the group in the mass of each of its nodes [kg]
    // Diagonal of the sum of the bounds V G W G^T on the stiffness of the elements e of the group. The gradients G of
    // an element, its volume V and W are those of the head of the file.
    std::vector<Real> diagonal{};
    std::vector<Real4> vector{};  // by node: values of four approximate highest modes
    Real highest = 0;             // lower bound on the highest eigenvalue of the group [1/s^2]
};

class FormSearch {
public:
    FormSearch(const ElementInputs& elements, Range blocks, std::span<const Vec3> position, std::span<const Real> mass,
               Real most_products, std::span<ElementForm> form)
        : elements_(elements),
          blocks_(blocks),
          most_products_(most_products),
          form_(form),
          weight_(form.size()),
          moduli_(elements, blocks, longer_by_forms) {
        Index last = 0;
        first_node_ = std::numeric_limits<Index>::max();
        for_each_node(blocks, [&](Index node) {
            first_node_ = std::min(first_node_, node);
            last = std::max(last, node);
        });
        const auto count = static_cast<std::size_t>(last + 1 - first_node_);
        mass_ = mass.subspan(static_cast<std::size_t>(first_node_), count);
        position_ = position.subspan(static_cast<std::size_t>(first_node_), count);
        vector_.resize(count);
        product_.resize(count);
        place_.resize(count, no_index);
    }

    /// Chooses the matrices Z, stored in form_ until Q is known, and computes the weights V W from Z (symbols: see the
    /// head of the file).
    void choose() {
        const bool large = form_.size() > blocks_of_large;
        const int rounds = large ? 1 : 16, products = large ? 1 : 5;
        constexpr Real noise_part = 0.3;  // noise added to the vectors in each round, to find missing modes
        // Search for the matrix Z of each element. It starts as a multiple of the identity. The final Z is the mean of
        // this start and of the results of all rounds.
        for (ElementForm& of_block : form_)
            for (std::size_t i = 0; i < 6; ++i)
                for (Real& lane : of_block[i].lane) lane = i < 3 ? Real{1} / 3 : 0;
        SplitMix noise(1);
        for (int round = 0; round < rounds; ++round) {
            weigh();
            for (std::size_t n = 0; n < vector_.size(); ++n)
                if (mass_[n] > 0) vector_[n] += (round == 0 ? 1 : noise_part) / std::sqrt(mass_[n]) * noise_of(noise);
            for (int p = 0; p < products; ++p) {
                std::ranges::fill(product_, Real4{});
                add_product(blocks_);
                // squared norm of all vectors, which are then scaled to the norm of random start vectors
                Real size = 0;
                for (std::size_t n = 0; n < vector_.size(); ++n) {
                    vector_[n] = mass_[n] > 0 ? product_[n] / mass_[n] : Real4{};
                    size += mass_[n] * sum_of(vector_[n] * vector_[n]);
                }
                const Real scale = std::sqrt(static_cast<Real>(4 * vector_.size()) / (3 * size));
                for (Real4& x : vector_) x *= scale;
            }
            follow(1 / static_cast<Real>(2 + round));
        }
        weigh();
    }

    /// Upper bound on the squared highest frequency with the stiffness sum_e G V W G^T (symbols: see the head of the
    /// file) [1/s^2]. The stiffness divided by this bound is at most the mass of the nodes.
    Real bound() {
        std::vector<ElementGroup> groups;
        cut(blocks_, groups);
        share(groups);
        constexpr Real above = 1.005;  // ratio of the first bound to the iterated value, which may be slightly too low
        Real bound = 0;
        for (const ElementGroup& group : groups) bound = std::max(bound, above * group.highest);
        for (const ElementGroup& group : groups) {
            const GroupMatrix matrix = matrix_of(group);
            const auto add_rows = [&](std::size_t row, Real* to, std::size_t) { add_row(matrix, row, to); };
            const BandMatrix band{group.node.size(), group.width, 1, add_rows};
            Real growth = above;
            for (; std::isfinite(bound) && !decomposition_.is_below(band, bound); growth *= growth) bound *= growth;
            forget_numbers(group);
        }
        return bound;
    }

    /// Computes the matrix Q of the mass form of each element from its weight V W (see weigh()).
    /// - Explicit element: Q = bound (V W)^-1. `bound`: result of bound().
    /// - Implicit element: Q is the unit matrix times form_of_implicit.
    /// - Unused lane (volume 0): Q is zero.
    void finish(Real bound) {
        for (std::size_t i = 0; i < form_.size(); ++i) {
            const Real8 volume = load(elements_.volume[first_block() + i]);
            const Real8 explicit_volume = moduli_.explicit_mask(first_block() + i) * volume,
                        none = Real8{} + form_of_implicit;
            Symmetric Q = Real8(Real8{} + bound) * inverse_of(load_form(weight_[i]));
            for (Real8* entry : {&Q.xx, &Q.yy, &Q.zz})
                *entry = explicit_volume > 0.0 ? *entry : volume > 0.0 ? none : Real8{};
            for (Real8* entry : {&Q.xy, &Q.yz, &Q.zx}) *entry = explicit_volume > 0.0 ? *entry : Real8{};
            store_form(Q, form_[i]);
        }
    }

private:
    std::size_t first_block() const { return static_cast<std::size_t>(blocks_.begin); }
    std::size_t local(Index node) const { return static_cast<std::size_t>(node - first_node_); }

    void for_each_node(Range blocks, auto&& visit) const {
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b) {
            const BlockNodes nodes = elements_.nodes_of(b);
            for (Index k = 0; k < nodes.count; ++k)
                for (const Index node : nodes.node[k].lane) visit(node);
        }
    }
    /// Calls visit(block, lane, nodes) for each element in a range of blocks.
    void for_each_element(Range blocks, auto&& visit) const {
        for (auto b = static_cast<std::size_t>(blocks.begin); b < static_cast<std::size_t>(blocks.end); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l)
                if (elements_.volume[b][l] > 0) visit(b, l, elements_.nodes_of(b));
    }

    /// Computes the weight V W of each explicit element. V is its volume. With Lame's mu and lambda and the present
    /// matrix Z in form_, W = 2 mu I + lambda tr(Z) Z^-1. The weight of implicit elements is zero.
    void weigh() {
        for (std::size_t i = 0; i < form_.size(); ++i) {
            const auto [shear, volumetric] = moduli_.moduli(first_block() + i);
            const Symmetric Z = load_form(form_[i]);
            Symmetric W = Real8(volumetric * Z.trace()) * inverse_of(Z);
            W.xx += shear;
            W.yy += shear;
            W.zz += shear;
            store_form(moduli_.explicit_mask(first_block() + i) * load(elements_.volume[first_block() + i]) * W,
                       weight_[i]);
        }
    }
    /// Gradients of the iterated vectors (estimates of the highest modes) in one element, by direction.
    std::array<Real4, 3> gradient_of_vectors(const BlockNodes& nodes, std::size_t l) const {
        Real4 along_x{}, along_y{}, along_z{};  // three variables instead of an array, so that they stay in registers
        for (Index k = 0; k < nodes.count; ++k) {
            const Real4& vectors = vector_[local(nodes.node[k][l])];
            const ElementGradient& g = nodes.gradient[k];
            along_x += g[0][l] * vectors;
            along_y += g[1][l] * vectors;
            along_z += g[2][l] * vectors;
        }
        return {along_x, along_y, along_z};
    }
    /// Adds to product_ the products of the iterated vectors with sum_e G V W G^T, a bound on the stiffness matrix. G
    /// contains the gradients of element e, and V W is its weight.
    void add_product(Range blocks) {
        for_each_element(blocks, [&](std::size_t b, std::size_t l, const BlockNodes& nodes) {
            const ElementForm& w = weight_[b - first_block()];
            if (w[0][l] == 0) return;  // an implicit element gets no mass
            const std::array<Real4, 3> t = gradient_of_vectors(nodes, l);
            const Real4 x = w[0][l] * t[0] + w[3][l] * t[1] + w[5][l] * t[2];
            const Real4 y = w[3][l] * t[0] + w[1][l] * t[1] + w[4][l] * t[2];
            const Real4 z = w[5][l] * t[0] + w[4][l] * t[1] + w[2][l] * t[2];
            for (Index k = 0; k < nodes.count; ++k) {
                const ElementGradient& g = nodes.gradient[k];
                product_[local(nodes.node[k][l])] += g[0][l] * x + g[1][l] * y + g[2][l] * z;
            }
        });
    }
    /// Moves Z by the fraction `part` towards the square root of the sum of grad v grad v^T over the iterated vectors v
    /// (estimates of the highest modes). Z and the square root are scaled to trace 1.
    void follow(Real part) {
        constexpr Real even = 0.03;  // weight of the isotropic matrix that is mixed into the target of Z
        for (std::size_t i = 0; i < form_.size(); ++i) {
            const std::size_t b = first_block() + i;
            const BlockNodes nodes = elements_.nodes_of(b);
            ElementForm sums{};
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const std::array<Real4, 3> t = gradient_of_vectors(nodes, l);
                for (std::size_t r = 0; r < 3; ++r) {
                    sums[r][l] = sum_of(t[r] * t[r]);
                    sums[3 + r][l] = sum_of(t[r] * t[(r + 1) % 3]);
                }
            }
            Symmetric C = load_form(sums);
            const Real8 trace = C.trace();
            const auto known = (trace > 1e-200) & (trace < 1e200);
            C = Real8(known ? (1 - even) / trace : Real8{}) * C;
            const Real8 third = known ? Real8{} + even / 3 : Real8{} + 1.0 / 3;
            C.xx += third;
            C.yy += third;
            C.zz += third;
            const Symmetric root = root_of(C);
            const Symmetric Z = load_form(form_[i]);
            store_form(mean_of(Z, Real8(1.0 / root.trace()) * root, part), form_[i]);
        }
    }

    /// Splits the elements into groups. Halves ranges of blocks until the matrix of each group can be decomposed at the
    /// allowed cost.
    void cut(Range blocks, std::vector<ElementGroup>& groups) {
        ElementGroup group{.blocks = blocks};
        for_each_node(blocks, [&](Index node) {
            Index& seen = place_[local(node)];
            if (seen != no_index) return;
            seen = 0;
            group.node.push_back(node - first_node_);
        });
        sort_along(position_, group.node);
        number(group);
        for_each_element(blocks, [&](std::size_t, std::size_t l, const BlockNodes& nodes) {
            Index low = place_[local(nodes.node[0][l])], high = low;
            for (Index k = 1; k < nodes.count; ++k) {
                low = std::min(low, place_[local(nodes.node[k][l])]);
                high = std::max(high, place_[local(nodes.node[k][l])]);
            }
            group.width = std::max(group.width, static_cast<std::size_t>(high - low + 1));
        });
        forget_numbers(group);
        const auto size = static_cast<Real>(group.node.size()), width = static_cast<Real>(group.width);
        if (size * width * width > 2 * most_products_ && blocks.size() > 1) {
            const Index middle = blocks.begin + blocks.size() / 2;
            cut({blocks.begin, middle}, groups);
            cut({middle, blocks.end}, groups);
            return;
        }
        groups.push_back(std::move(group));
    }
    void number(const ElementGroup& group) {
        for (std::size_t i = 0; i < group.node.size(); ++i)
            place_[static_cast<std::size_t>(group.node[i])] = static_cast<Index>(i);
    }
    void forget_numbers(const ElementGroup& group) {
        for (const Index n : group.node) place_[static_cast<std::size_t>(n)] = no_index;
    }

    /// Divides the mass of each node among the groups that contain the node. The shares are balanced like the mass
    /// shares of elements (find_mass_shares in stable_step.h).
    void share(std::vector<ElementGroup>& groups) {
        constexpr int rounds = 4, products = 8;
        std::vector<Real> node_diagonal(vector_.size()), share(groups.size(), 1);
        for (ElementGroup& group : groups) {
            add_diagonal(group);
            for (const Index n : group.node) group.vector.push_back(vector_[static_cast<std::size_t>(n)]);
        }
        for (int round = 0; round < rounds; ++round) {
            std::ranges::fill(node_diagonal, Real{0});
            for (std::size_t g = 0; g < groups.size(); ++g)
                for (std::size_t i = 0; i < groups[g].node.size(); ++i)
                    node_diagonal[static_cast<std::size_t>(groups[g].node[i])] += share[g] * groups[g].diagonal[i];
            Real highest = 0;
            for (std::size_t g = 0; g < groups.size(); ++g) {
                ElementGroup& group = groups[g];
                group.mass.resize(group.node.size());
                for (std::size_t i = 0; i < group.node.size(); ++i) {
                    const auto n = static_cast<std::size_t>(group.node[i]);
                    group.mass[i] =
                        node_diagonal[n] > 0 ? mass_[n] * (share[g] * group.diagonal[i] / node_diagonal[n]) : 0;
                }
                group.highest = highest_of(group, products);
                highest = std::max(highest, group.highest);
            }
            if (groups.size() == 1 || !(highest > 0) || round + 1 == rounds) return;
            for (std::size_t g = 0; g < groups.size(); ++g) share[g] *= std::sqrt(groups[g].highest / highest);
        }
    }
    void add_diagonal(ElementGroup& group) {
        std::vector<Real> sum(vector_.size());
        for_each_element(group.blocks, [&](std::size_t b, std::size_t l, const BlockNodes& nodes) {
            const ElementForm& w = weight_[b - first_block()];
            for (Index k = 0; k < nodes.count; ++k) {
                const Real x = nodes.gradient[k][0][l], y = nodes.gradient[k][1][l], z = nodes.gradient[k][2][l];
                sum[local(nodes.node[k][l])] += w[0][l] * x * x + w[1][l] * y * y + w[2][l] * z * z +
                                                2 * (w[3][l] * x * y + w[4][l] * y * z + w[5][l] * z * x);
            }
        });
        for (const Index n : group.node) group.diagonal.push_back(sum[static_cast<std::size_t>(n)]);
    }
    /// Greatest Rayleigh quotient of the four iterated vectors of a group, after `products` products with the matrix of
    /// the group. It is a lower bound on the highest eigenvalue of the group [1/s^2].
    Real highest_of(ElementGroup& group, int products) {
        Real highest = 0;
        for (int p = 0; p < products; ++p) {
            for (std::size_t i = 0; i < group.node.size(); ++i) {
                vector_[static_cast<std::size_t>(group.node[i])] = group.vector[i];
                product_[static_cast<std::size_t>(group.node[i])] = Real4{};
            }
            add_product(group.blocks);
            Real4 energy{}, size{};
            for (std::size_t i = 0; i < group.node.size(); ++i) {
                const Real4& product = product_[static_cast<std::size_t>(group.node[i])];
                energy += group.vector[i] * product;
                size += group.mass[i] * (group.vector[i] * group.vector[i]);
                group.vector[i] = group.mass[i] > 0 ? product / group.mass[i] : Real4{};
            }
            highest = 0;
            for (int v = 0; v < 4; ++v)
                if (size[v] > 0) highest = std::max(highest, energy[v] / size[v]);
            if (!(highest > 0)) return 0;
            for (Real4& x : group.vector) x /= highest;
        }
        return highest;
    }

    /// Data of the matrix M^-1/2 (sum_e G V W G^T) M^-1/2 of a group, whose highest eigenvalue is sought. M is the mass
    /// matrix of the group. G contains the gradients of element e, and V W is its weight.
    struct GroupMatrix {
        std::vector<Real> scale;        // inverse square root of the mass, by node along the group [1/sqrt(kg)]
        Ragged<ElementCorner> corners;  // corners of elements at each node along the group
    };
    /// Collects the data of the matrix of a group, and numbers the nodes of the group.
    GroupMatrix matrix_of(const ElementGroup& group) {
        number(group);
        GroupMatrix matrix{
            std::vector<Real>(group.node.size()), corners_at(group.node.size(), [&](auto&& visit) {
                for_each_element(group.blocks, [&](std::size_t b, std::size_t l, const BlockNodes& nodes) {
                    for (Index k = 0; k < nodes.count; ++k)
                        visit(static_cast<std::size_t>(place_[local(nodes.node[k][l])]), ElementCorner{b, l, k});
                });
            })};
        for (std::size_t i = 0; i < matrix.scale.size(); ++i)
            matrix.scale[i] = group.mass[i] > 0 ? 1 / std::sqrt(group.mass[i]) : 0;
        return matrix;
    }
    void add_row(const GroupMatrix& matrix, std::size_t row, Real* to) const {
        for (const ElementCorner& corner : matrix.corners[row]) {
            const std::size_t l = corner.lane;
            const ElementForm& w = weight_[corner.block - first_block()];
            const BlockNodes nodes = elements_.nodes_of(corner.block);
            const ElementGradient& own = nodes.gradient[corner.corner];
            const Real scale = matrix.scale[row], x = scale * own[0][l], y = scale * own[1][l], z = scale * own[2][l];
            const Real wx = w[0][l] * x + w[3][l] * y + w[5][l] * z, wy = w[3][l] * x + w[1][l] * y + w[4][l] * z,
                       wz = w[5][l] * x + w[4][l] * y + w[2][l] * z;
            for (Index j = 0; j < nodes.count; ++j) {
                const ElementGradient& g = nodes.gradient[j];
                const auto column = static_cast<std::size_t>(place_[local(nodes.node[j][l])]);
                if (column >= row)
                    to[column - row] += matrix.scale[column] * (wx * g[0][l] + wy * g[1][l] + wz * g[2][l]);
            }
        }
    }
    const ElementInputs& elements_;
    Range blocks_;
    Real most_products_;
    Index first_node_ = 0;
    std::span<const Vec3> position_;       // positions from the first node of the body on [m]
    std::span<const Real> mass_;           // masses from the first node of the body on [kg]
    std::span<ElementForm> form_;          // Z, then Q
    std::vector<ElementForm> weight_;      // weights V W [Pa m^3]
    std::vector<Real4> vector_, product_;  // by node: four iterated vectors; their products with the stiffness
    RestModuli moduli_;
    std::vector<Index> place_;  // index of each node in ElementGroup::node of the present group, or no_index
    BandDecomposition decomposition_;
};

}  // namespace

void find_mass_forms(const ElementInputs& elements, Range blocks, std::span<const Vec3> position,
                     std::span<const Real> mass, Real most_products, std::span<ElementForm> form) {
    SKERRY_CHECK(form.size() == static_cast<std::size_t>(blocks.size()));
    const Range element_blocks = without_guards(elements, blocks);
    std::ranges::fill(form.subspan(static_cast<std::size_t>(element_blocks.size())), ElementForm{});
    form = form.first(static_cast<std::size_t>(element_blocks.size()));
    if (element_blocks.size() == 0) return;
    FormSearch search(elements, element_blocks, position, mass, most_products, form);
    search.choose();
    const Real bound = search.bound();
    if (bound > 0 && std::isfinite(bound))
        search.finish(bound);
    else
        std::ranges::fill(form, ElementForm{});
}

}  // namespace skerry
