#include "systems/dynamics/elements/recover_fields.h"

#include "components/element_table.h"

namespace skerry {

namespace {

constexpr std::size_t parts = 3;

/// Mean of a field over the elements that cover a tetrahedron. Each part of the stress (ElementPart) has its own mean.
struct Mean {
    std::array<Mat3, parts> sum{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
    std::array<int, parts> count{};

    Mat3 mean_part(ElementPart part) const {
        const auto p = static_cast<std::size_t>(part);
        return count[p] > 0 ? Mat3(sum[p] / count[p]) : Mat3(Mat3::Zero());
    }
};

std::vector<Mean> means_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> element_values,
                                      std::size_t count) {
    std::vector<Mean> mean(count);
    for (std::size_t element = 0; element < cover.tetrahedra.size(); ++element) {
        const auto part = static_cast<std::size_t>(cover.part[element / element_lanes]);
        for (const Index t : cover.tetrahedra[element]) {
            Mean& entry = mean[static_cast<std::size_t>(t)];
            entry.sum[part] += element_values[element];
            ++entry.count[part];
        }
    }
    return mean;
}

}  // namespace

std::vector<Mat3> stress_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> element_values,
                                       std::size_t count) {
    std::vector<Mat3> stress;
    stress.reserve(count);
    for (const Mean& mean : means_of_tetrahedra(cover, element_values, count))
        stress.push_back(mean.mean_part(ElementPart::whole) + mean.mean_part(ElementPart::shear) +
                         mean.mean_part(ElementPart::volume));
    return stress;
}

std::vector<Mat3> strain_of_tetrahedra(const ElementCover& cover, std::span<const Mat3> element_values,
                                       std::size_t count) {
    std::vector<Mat3> strain;
    strain.reserve(count);
    for (const Mean& mean : means_of_tetrahedra(cover, element_values, count))
        strain.push_back(mean.mean_part(ElementPart::whole) + mean.mean_part(ElementPart::shear));
    return strain;
}

std::vector<Real> mean_of_tetrahedra(const ElementCover& cover, std::span<const ElementLane> block_values,
                                     std::size_t count) {
    std::vector<Real> sum(count), covers(count);
    for (std::size_t element = 0; element < cover.tetrahedra.size(); ++element) {
        const std::size_t block = element / element_lanes;
        if (cover.part[block] == ElementPart::volume) continue;
        for (const Index t : cover.tetrahedra[element]) {
            sum[static_cast<std::size_t>(t)] += block_values[block][element % element_lanes];
            ++covers[static_cast<std::size_t>(t)];
        }
    }
    for (std::size_t t = 0; t < count; ++t)
        if (covers[t] > 0) sum[t] /= covers[t];
    return sum;
}

}  // namespace skerry
