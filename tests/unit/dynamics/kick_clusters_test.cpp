// The kick of nodes coupled by one matrix, computed from one triangle of it, against a row-by-row sum.
#include "systems/dynamics/clusters/kick_clusters.h"

#include <catch2/catch.hpp>

#include "tests/support/elastic_body.h"

namespace skerry::test::kick_clusters_test {

namespace {

/// Clusters with these widths of every other node, with arbitrary symmetric matrices.
struct KickedNodes {
    NodeClusters clusters;
    std::vector<Real> mass;
    std::vector<Vec3> velocity, predicted;

    explicit KickedNodes(std::span<const Index> widths) {
        std::mt19937_64 random(7);
        std::uniform_real_distribution<Real> entry(-1, 1);
        clusters.nodes.offset.push_back(0);
        for (std::size_t c = 0; c < widths.size(); ++c) {
            const auto width = static_cast<std::size_t>(widths[c]);
            for (std::size_t k = 0; k < width; ++k) {
                clusters.nodes.item.push_back(static_cast<Index>(mass.size()));
                for (int neighbour = 0; neighbour < 2; ++neighbour) {  // the first is in the cluster, the second is not
                    mass.push_back(1 + entry(random) / 2);
                    velocity.push_back(test::random_vector(random));
                    predicted.push_back(test::random_vector(random));
                }
            }
            clusters.nodes.offset.push_back(static_cast<Index>(clusters.nodes.item.size()));
            clusters.body.push_back(static_cast<Index>(c));
            clusters.first_entry.push_back(clusters.inverse.size());
            const std::size_t first = clusters.inverse.size();
            clusters.inverse.resize(first + width * width);
            for (std::size_t i = 0; i < width; ++i)
                for (std::size_t k = 0; k <= i; ++k)
                    clusters.inverse[first + i * width + k] = clusters.inverse[first + k * width + i] = entry(random);
        }
    }
    std::vector<Vec3> kick(std::span<const std::uint8_t> asleep) const {
        const auto executor = make_executor(Backend::serial, 1);
        std::vector<Vec3> next = predicted;
        Column<Vec3> impulse;
        Column<Real> work;
        CHECK(kick_clusters(*executor, {clusters, mass, asleep}, velocity, false, impulse, work, next));
        std::vector<Vec3> again = predicted;  // with the impulse from the first kick
        CHECK(kick_clusters(*executor, {clusters, mass, asleep}, velocity, true, impulse, work, again));
        CHECK(again == next);
        return next;
    }
    /// Reference result: row by row, node by node.
    std::vector<Vec3> kick_one_by_one() const {
        std::vector<Vec3> next = predicted;
        for (std::size_t c = 0; c < clusters.size(); ++c)
            for (std::size_t k = 0; k < clusters.nodes[c].size(); ++k) {
                const std::span<const Real> row = clusters.row(static_cast<Index>(c), static_cast<Index>(k));
                Vec3 sum = Vec3::Zero();
                for (std::size_t j = 0; j < row.size(); ++j) {
                    const auto n = static_cast<std::size_t>(clusters.nodes[c][j]);
                    const Vec3 impulse = mass[n] * (predicted[n] - velocity[n]);
                    sum += row[j] * impulse;
                }
                const auto of = static_cast<std::size_t>(clusters.nodes[c][k]);
                next[of] = velocity[of] + sum;
            }
        return next;
    }
};

}  // namespace

TEST_CASE("clusters of any width are kicked as row by row", "[unit][clusters]") {
    const std::vector<Index> widths{1, 2, 3, 4, 5, 7, 8, 9, 12, 15, 16, 17, 31, 32, 33, 40, 64, 71};
    const KickedNodes nodes(widths);
    const std::vector<Vec3> next = nodes.kick({}), one_by_one = nodes.kick_one_by_one();
    for (std::size_t n = 0; n < next.size(); ++n) {
        CHECK((next[n] - one_by_one[n]).norm() < 1e-13);  // rounding of sums of up to 71 products of size 1
        if (n % 2 == 1) CHECK(next[n] == nodes.predicted[n]);
    }
}

TEST_CASE("clusters of bodies at rest are not kicked", "[unit][clusters]") {
    const std::vector<Index> widths{4, 9};
    const KickedNodes nodes(widths);
    const std::vector<std::uint8_t> asleep{1, 0};
    const std::vector<Vec3> next = nodes.kick(asleep), all = nodes.kick_one_by_one();
    for (std::size_t n = 0; n < next.size(); ++n)
        CHECK((next[n] - (n < 8 ? nodes.predicted[n] : all[n])).norm() < (n < 8 ? 1e-300 : 1e-13));
}

}  // namespace skerry::test::kick_clusters_test
