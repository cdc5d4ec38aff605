#include "systems/dynamics/stability/mass_search.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "components/split_mix.h"

namespace skerry::test::mass_search_test {

namespace {

/// A symmetric band matrix. Each row stores its entries from the diagonal on.
struct Band {
    std::size_t size, width, group;
    std::vector<Real> entry;

    bool is_below(Real limit, BandDecomposition& decomposition) const {
        const auto add_rows = [&](std::size_t of_group, Real* rows, std::size_t stride) {
            for (std::size_t i = 0; i < group; ++i)
                for (std::size_t j = 0; j < width; ++j)
                    rows[i * stride + j] += entry[(of_group * group + i) * width + j];
        };
        return decomposition.is_below({size, width, group, add_rows}, limit);
    }
    /// Reference result: eliminates the whole matrix at once, pivot by pivot.
    bool is_plainly_below(Real limit) const {
        std::vector<Real> rest = entry;
        for (std::size_t k = 0; k < size; ++k)
            for (std::size_t j = 0; j < width; ++j) rest[k * width + j] = (j == 0 ? limit : 0) - entry[k * width + j];
        for (std::size_t k = 0; k < size; ++k) {
            const Real* const row = &rest[k * width];
            if (!(row[0] > 1e-10 * limit)) return false;
            const Real inverse = 1 / row[0];
            const std::size_t end = std::min(width, size - k);
            for (std::size_t i = 1; i < end; ++i) {
                const Real factor = row[i] * inverse;
                for (std::size_t j = 0; j < end - i; ++j) rest[(k + i) * width + j] -= factor * row[i + j];
            }
        }
        return true;
    }
};

/// Rows fill the band or, often, less of it; some have only the diagonal.
Band random_band(std::size_t size, std::size_t width, std::size_t group, SplitMix& random) {
    Band band{size, width, group, std::vector<Real>(size * width)};
    for (std::size_t k = 0; k < size; ++k) {
        const Real reach = random.symmetric();
        for (std::size_t j = 0; j < std::min(width, size - k); ++j)
            if (j == 0 || static_cast<Real>(j) < reach * static_cast<Real>(2 * width))
                band.entry[k * width + j] = (j == 0 ? 3 : 1) * random.symmetric();
    }
    return band;
}

}  // namespace

TEST_CASE("a band is decomposed in a window to the bit as all at once", "[unit]") {
    SplitMix random(1);
    BandDecomposition decomposition;
    for (const std::size_t group : {1u, 3u})
        for (const std::size_t groups : {1u, 2u, 3u, 5u, 8u, 40u, 131u})
            for (const std::size_t width : {1u, 2u, 3u, 4u, 7u, 12u, 33u, 200u}) {
                if (width > group * groups) continue;
                const Band band = random_band(group * groups, width, group, random);
                INFO(group << " rows, " << groups << " times, " << width << " wide");
                // bisects to the two neighbouring numbers between which the answer changes
                Real low = 0, high = 1;
                while (!band.is_plainly_below(high)) high *= 2;
                CHECK(band.is_below(high, decomposition));
                for (Real middle = (low + high) / 2; low < middle && middle < high; middle = (low + high) / 2) {
                    const bool below = band.is_plainly_below(middle);
                    REQUIRE(band.is_below(middle, decomposition) == below);
                    (below ? high : low) = middle;
                }
                CHECK(band.is_below(low, decomposition) == band.is_plainly_below(low));
                CHECK_FALSE(band.is_below(std::numeric_limits<Real>::quiet_NaN(), decomposition));
            }
}

TEST_CASE("corners are found at their places element by element", "[unit]") {
    const auto corners = corners_at(3, [](auto&& visit) {
        visit(std::size_t{2}, ElementCorner{0, 0, 0});
        visit(std::size_t{0}, ElementCorner{0, 0, 1});
        visit(std::size_t{2}, ElementCorner{0, 5, 3});
        visit(std::size_t{2}, ElementCorner{7, 1, 2});
    });
    REQUIRE(corners.size() == 3);
    REQUIRE(corners[0].size() == 1);
    CHECK(corners[0][0].corner == 1);
    CHECK(corners[1].empty());
    REQUIRE(corners[2].size() == 3);
    CHECK(corners[2][0].block == 0);
    CHECK(corners[2][1].lane == 5);
    CHECK(corners[2][2].block == 7);
}

}  // namespace skerry::test::mass_search_test
