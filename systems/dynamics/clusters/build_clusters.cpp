#include "systems/dynamics/clusters/build_clusters.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>
#include <vector>

#include "systems/dynamics/clusters/chain_nodes.h"
#include "systems/dynamics/clusters/implicit_elements.h"

namespace skerry {

namespace {

void chain(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
           std::span<const Real> inverse_mass, UnionFind& sets, std::vector<Index>& nodes) {
    for_each_implicit(blocks, modulus, [&](std::size_t b, std::size_t l, Real) {
        Index root = no_index;
        for_each_node(elements.nodes_of(b), l, inverse_mass, [&](Index n, Index) {
            nodes.push_back(n);
            const Index other = sets.root(n);
            if (root != other) root = root == no_index ? other : sets.join_roots(root, other);
        });
    });
}

void sort_unique(std::vector<Index>& nodes) {
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

/// Numbers the clusters of a body in the order of their first nodes and lists the nodes of each cluster.
void list_nodes(std::span<const Index> nodes, Index body, UnionFind& sets, NodeClusters& clusters) {
    const auto first = static_cast<Index>(clusters.body.size());
    for (const Index n : nodes) {
        const Index root = sets.root(n);  // smallest node of the set; the loop visits it before the other nodes
        if (root == n) {
            clusters.cluster_of[n] = static_cast<Index>(clusters.body.size());
            clusters.body.push_back(body);
        } else {
            clusters.cluster_of[n] = clusters.cluster_of[root];
        }
    }
    for (auto c = first; c < static_cast<Index>(clusters.body.size()); ++c) {
        for (const Index n : nodes)
            if (clusters.cluster_of[n] == c) {
                clusters.index_in_cluster[n] =
                    static_cast<Index>(clusters.nodes.item.size()) - clusters.nodes.offset.back();
                clusters.nodes.item.push_back(n);
            }
        clusters.nodes.offset.push_back(static_cast<Index>(clusters.nodes.item.size()));
    }
}

/// Lists the clusters of a body and inverts their inertia matrices.
void build(const ElementInputs& elements, const ClusterInputs& inputs, std::size_t body, UnionFind& sets,
           NodeClusters& clusters) {
    const Range blocks = inputs.body_blocks[body];
    const auto modulus =
        inputs.modulus.subspan(static_cast<std::size_t>(blocks.begin), static_cast<std::size_t>(blocks.size()));
    std::vector<Index> nodes;
    chain(elements, blocks, modulus, inputs.inverse_mass, sets, nodes);
    sort_unique(nodes);
    const std::size_t first = clusters.size();
    list_nodes(nodes, static_cast<Index>(body), sets, clusters);
    std::vector<Eigen::MatrixXd> A;
    for (std::size_t c = first; c < clusters.size(); ++c) {
        const auto of_cluster = clusters.nodes[c];
        const auto count = static_cast<Eigen::Index>(of_cluster.size());
        A.emplace_back(Eigen::MatrixXd::Zero(count, count));
        for (Eigen::Index i = 0; i < count; ++i)
            A.back()(i, i) = inputs.mass[static_cast<std::size_t>(of_cluster[static_cast<std::size_t>(i)])];
    }
    const Real beta = inertia_factor(inputs.body_cluster_step[body]);
    for_each_implicit(blocks, modulus, [&](std::size_t b, std::size_t l, Real m) {
        const BlockNodes block_nodes = elements.nodes_of(b);
        const Real weight = beta * m * elements.volume[b][l];
        for_each_node(block_nodes, l, inputs.inverse_mass, [&](Index n, Index k) {
            Eigen::MatrixXd& matrix = A[static_cast<std::size_t>(clusters.cluster_of[n]) - first];
            for_each_node(block_nodes, l, inputs.inverse_mass, [&](Index other, Index j) {
                Real product = 0;
                for (std::size_t i = 0; i < 3; ++i)
                    product += block_nodes.gradient[k][i][l] * block_nodes.gradient[j][i][l];
                matrix(clusters.index_in_cluster[n], clusters.index_in_cluster[other]) += weight * product;
            });
        });
    });
    for (const Eigen::MatrixXd& matrix : A) {
        const Eigen::MatrixXd inverse = matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
        const std::size_t begin = clusters.inverse.size();
        clusters.first_entry.push_back(begin);
        clusters.inverse.resize(begin + static_cast<std::size_t>(inverse.size()));
        // Mirrors the upper triangle, so that the inverse is bitwise symmetric. Contact i then changes the velocity of
        // contact j exactly as j changes that of i.
        for (Eigen::Index i = 0; i < inverse.rows(); ++i)
            for (Eigen::Index j = 0; j < inverse.cols(); ++j)
                clusters.inverse[begin + static_cast<std::size_t>(i * inverse.cols() + j)] =
                    i < j ? inverse(i, j) : inverse(j, i);
    }
}

/// Copies cluster `c` of `before` unchanged to the end of `clusters`.
void keep(const NodeClusters& before, std::size_t c, NodeClusters& clusters) {
    const std::span<const Index> nodes = before.nodes[c];
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        clusters.cluster_of[nodes[k]] = static_cast<Index>(clusters.body.size());
        clusters.index_in_cluster[nodes[k]] = static_cast<Index>(k);
        clusters.nodes.item.push_back(nodes[k]);
    }
    clusters.nodes.offset.push_back(static_cast<Index>(clusters.nodes.item.size()));
    clusters.body.push_back(before.body[c]);
    const std::size_t begin = clusters.inverse.size(), entries = nodes.size() * nodes.size();
    clusters.first_entry.push_back(begin);
    clusters.inverse.resize(begin + entries);
    std::ranges::copy(before.inverse.span().subspan(before.first_entry[c], entries),
                      clusters.inverse.begin() + static_cast<std::ptrdiff_t>(begin));
}

}  // namespace

ClusterSizes cluster_sizes(const ElementInputs& elements, Range blocks, std::span<const ElementLane> modulus,
                           std::span<const Real> inverse_mass) {
    ConnectedNodes connected(elements, blocks, modulus, inverse_mass);
    ClusterSizes sizes;
    std::vector<std::size_t> width(connected.is_connected.begin(), connected.is_connected.end());
    for (std::size_t n = width.size(); n-- > 0;) {
        const auto root = static_cast<std::size_t>(connected.sets.root(static_cast<Index>(n)));
        if (root != n) width[root] += std::exchange(width[n], 0);
    }
    for (const std::size_t count : width) {
        sizes.largest = std::max(sizes.largest, count);
        sizes.entries += count * count;
        sizes.cubes += count * count * count;
    }
    return sizes;
}

void build_clusters(const ElementInputs& elements, const ClusterInputs& inputs, NodeClusters& clusters) {
    clusters.clear();
    const std::vector<std::uint8_t> every(inputs.body_blocks.size(), 1);
    rebuild_clusters(elements, inputs, every, clusters);
}

void rebuild_clusters(const ElementInputs& elements, const ClusterInputs& inputs,
                      std::span<const std::uint8_t> body_changed, NodeClusters& clusters) {
    const NodeClusters before = std::exchange(clusters, {});
    if (std::ranges::none_of(inputs.body_cluster_step, [](Real step) { return step > 0; })) return;
    const std::size_t node_count = inputs.mass.size();
    clusters.cluster_of.assign(node_count, no_index);
    clusters.index_in_cluster.assign(node_count, no_index);
    clusters.nodes.offset.push_back(0);
    UnionFind sets;
    sets.start(node_count);
    std::size_t next = 0;  // first cluster of `before` that is not handled yet
    for (std::size_t body = 0; body < inputs.body_blocks.size(); ++body) {
        const auto is_of_body = [&] { return next < before.size() && before.body[next] == static_cast<Index>(body); };
        for (; is_of_body(); ++next)
            if (!body_changed[body]) keep(before, next, clusters);
        if (body_changed[body] && inputs.body_cluster_step[body] > 0) build(elements, inputs, body, sets, clusters);
    }
}

}  // namespace skerry
