#include "systems/dynamics/elements/recover_fields.h"

#include <algorithm>

#include "components/check.h"
#include "components/element_table.h"

namespace skerry {

namespace {

constexpr std::size_t parts = 3;

/// Mean of a field over the elements that cover a tetrahedron. Each part of the stress (ElementPart) has its own mean.
struct Mean {
    std::array<Mat3, parts> sum{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
    std::array<int, parts> count{};

    Mat3 of(ElementPart part) const {
        const auto p = static_cast<std::size_t>(part);
        return count[p] > 0 ? Mat3(sum[p] / count[p]) : Mat3(Mat3::Zero());
    }
};

std::vector<Mean> means_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements, std::size_t count) {
    std::vector<Mean> mean(count);
    for (std::size_t place = 0; place < cover.tetrahedra.size(); ++place) {
        const auto part = static_cast<std::size_t>(cover.part[place / element_lanes]);
        for (const Index t : cover.tetrahedra[place]) {
            Mean& of = mean[static_cast<std::size_t>(t)];
            of.sum[part] += of_elements[place];
            ++of.count[part];
        }
    }
    return mean;
}

}  // namespace

ElementsAround elements_around(const ElementCover& cover, std::span<const std::array<Index, 4>> tetrahedra,
                               std::span<const Index> nodes, std::size_t node_count) {
    const auto other = static_cast<Index>(nodes.size());
    std::vector<Index> place(node_count, other), row(tetrahedra.size(), no_index);
    for (std::size_t i = 0; i < nodes.size(); ++i) place[static_cast<std::size_t>(nodes[i])] = static_cast<Index>(i);
    ElementsAround around;
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
        const auto of = [&](std::size_t k) { return place[static_cast<std::size_t>(tetrahedra[t][k])]; };
        const std::array<Index, 4> of_tetrahedron{of(0), of(1), of(2), of(3)};
        if (std::ranges::min(of_tetrahedron) == other) continue;
        row[t] = static_cast<Index>(around.tetrahedron.size());
        around.tetrahedron.push_back(static_cast<Index>(t));
        around.corners.push_back(of_tetrahedron);
    }
    const auto is_around = [&](Index t) { return row[static_cast<std::size_t>(t)] != no_index; };
    around.covered.offset.push_back(0);
    for (std::size_t first = 0; first < cover.tetrahedra.size(); first += element_lanes) {
        const std::size_t last = std::min(first + element_lanes, cover.tetrahedra.size());
        const auto begin = static_cast<std::size_t>(cover.tetrahedra.offset[first]),
                   end = static_cast<std::size_t>(cover.tetrahedra.offset[last]);
        if (std::ranges::none_of(cover.tetrahedra.item.subspan(begin, end - begin), is_around)) continue;
        around.block.push_back(static_cast<Index>(first / element_lanes));
        around.part.push_back(cover.part[first / element_lanes]);
        for (std::size_t at = first; at < first + element_lanes; ++at) {
            if (at < last)
                for (const Index t : cover.tetrahedra[at])
                    if (is_around(t)) around.covered.item.push_back(row[static_cast<std::size_t>(t)]);
            around.covered.offset.push_back(static_cast<Index>(around.covered.item.size()));
        }
    }
    return around;
}

std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements,
                                       std::size_t count) {
    std::vector<Mat3> stress;
    stress.reserve(count);
    for (const Mean& mean : means_of_tetrahedra(cover, of_elements, count))
        stress.push_back(mean.of(ElementPart::whole) + mean.of(ElementPart::shear) + mean.of(ElementPart::volume));
    return stress;
}

std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> of_elements,
                                       std::size_t count) {
    std::vector<Mat3> strain;
    strain.reserve(count);
    for (const Mean& mean : means_of_tetrahedra(cover, of_elements, count))
        strain.push_back(mean.of(ElementPart::whole) + mean.of(ElementPart::shear));
    return strain;
}

std::vector<Mat3> means_of_nodes(std::span<const std::array<Index, 4>> tetrahedra, std::span<const Real> volume,
                                 std::span<const Mat3> of_tetrahedra, std::size_t node_count) {
    SKERRY_CHECK(volume.size() >= tetrahedra.size() && of_tetrahedra.size() >= tetrahedra.size());
    std::vector<Mat3> mean(node_count, Mat3::Zero());
    std::vector<Real> weight(node_count);
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        for (const Index n : tetrahedra[t]) {
            mean[static_cast<std::size_t>(n)] += volume[t] * of_tetrahedra[t];
            weight[static_cast<std::size_t>(n)] += volume[t];
        }
    for (std::size_t n = 0; n < node_count; ++n)
        if (weight[n] > 0) mean[n] /= weight[n];
    return mean;
}

}  // namespace skerry
