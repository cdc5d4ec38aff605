#include <algorithm>
#include <numeric>
#include <utility>

#include "systems/dynamics/kinds/element_list.h"

namespace skerry {

namespace {

std::vector<Real> volumes_six_times(const RestMesh& mesh) {
    std::vector<Real> six_volume;
    for (const auto& tetrahedron : mesh.tetrahedra) six_volume.push_back(six_volumes(tetrahedron, mesh.position));
    return six_volume;
}

/// Of each node: the mean of what `six_volume` has of the tetrahedra around it.
std::vector<Real> mean_around_nodes(const RestMesh& mesh, std::span<const Real> six_volume) {
    std::vector<Real> mean(mesh.position.size(), 0), around(mesh.position.size(), 0);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const Index n : mesh.tetrahedra[t]) {
            mean[static_cast<std::size_t>(n)] += six_volume[t];
            around[static_cast<std::size_t>(n)] += 1;
        }
    for (std::size_t n = 0; n < mean.size(); ++n)
        if (around[n] > 0) mean[n] /= around[n];
    return mean;
}

}  // namespace

std::vector<std::uint8_t> sliver_tetrahedra(const RestMesh& mesh) {
    const std::vector<Real> six_volume = volumes_six_times(mesh), around = mean_around_nodes(mesh, six_volume);
    std::vector<std::uint8_t> sliver;
    for (std::size_t t = 0; t < six_volume.size(); ++t)
        sliver.push_back(std::ranges::all_of(mesh.tetrahedra[t], [&](Index n) {
            return six_volume[t] < sliver_volume * around[static_cast<std::size_t>(n)];
        }));
    return sliver;
}

std::vector<std::uint8_t> tiny_tetrahedra(const RestMesh& mesh) {
    constexpr Real largest = 0.1;                              // of the mean volume
    constexpr Real most_together = 0.01;                       // of the volume of all
    const std::vector<Real> volume = volumes_six_times(mesh);  // what they are compared with is six times as much, too
    std::vector<std::uint8_t> tiny(volume.size(), 0);
    if (volume.empty()) return tiny;
    const std::vector<std::uint8_t> sliver = sliver_tetrahedra(mesh);
    const Real all = std::accumulate(volume.begin(), volume.end(), Real(0));
    // Halves, not one after the other until the sum is reached: equal ones, as symmetric meshes have, go together.
    for (Real bound = largest * all / static_cast<Real>(volume.size());; bound /= 2) {
        Real together = 0;
        for (std::size_t t = 0; t < volume.size(); ++t) {
            tiny[t] = sliver[t] == 0 && volume[t] < bound;
            if (tiny[t] != 0) together += volume[t];
        }
        if (!(together > most_together * all)) return tiny;
    }
}

void part_tiny_tetrahedra(const RestMesh& mesh, std::vector<MaterialZone>& zones) {
    const std::vector<std::uint8_t> tiny = tiny_tetrahedra(mesh);
    std::vector<MaterialZone> parted;
    for (MaterialZone& zone : zones) {
        MaterialZone linear{zone.material, ElementKind::linear, {}};
        if (zone.kind != ElementKind::linear)
            std::erase_if(zone.tetrahedra, [&](Index t) {
                if (!tiny[static_cast<std::size_t>(t)]) return false;
                linear.tetrahedra.push_back(t);
                return true;
            });
        if (!zone.tetrahedra.empty()) parted.push_back(std::move(zone));
        if (!linear.tetrahedra.empty()) parted.push_back(std::move(linear));
    }
    zones = std::move(parted);
}

}  // namespace skerry
