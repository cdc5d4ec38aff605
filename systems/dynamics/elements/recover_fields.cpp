#include "systems/dynamics/elements/recover_fields.h"

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

std::vector<Real> mean_of_tetrahedra(const ElementCover& cover, std::span<const ElementLane> of_blocks,
                                     std::size_t count) {
    std::vector<Real> sum(count), covers(count);
    for (std::size_t place = 0; place < cover.tetrahedra.size(); ++place) {
        const std::size_t block = place / element_lanes;
        if (cover.part[block] == ElementPart::volume) continue;
        for (const Index t : cover.tetrahedra[place]) {
            sum[static_cast<std::size_t>(t)] += of_blocks[block][place % element_lanes];
            ++covers[static_cast<std::size_t>(t)];
        }
    }
    for (std::size_t t = 0; t < count; ++t)
        if (covers[t] > 0) sum[t] /= covers[t];
    return sum;
}

}  // namespace skerry
