// What a run of a scene leaves behind, whoever ran it, and how far two runs are apart.
#pragma once

#include <array>
#include <vector>

#include "profiling/work_precision/scene.h"

namespace skerry::profiling {

struct Record {
    bool finished = false;
    double seconds = 0;                         // CPU time of the steps, median of the repeats
    double steps = 0;                           // taken
    Real step = 0;                              // s
    std::vector<std::vector<Vec3>> positions;   // m, by sample: all nodes of all bodies
    std::vector<std::vector<Vec3>> velocities;  // m/s
};

/// Distance of two runs of the same scene at one sample, sqrt(sum m |x - y|^2 / sum m) / L (mass-weighted).
Real distance_at(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t sample);

/// Its mean over the first `samples` samples: L1 in time, so that an impact that comes a little late counts by as much
/// as it is late. Infinite where one of the runs did not get so far.
Real mean_distance(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t samples);

/// Points of material, the same on every mesh of a scene: where they are is interpolated in the tetrahedra that hold
/// them.
class Probes {
public:
    Probes(const PrecisionScene& scene, int points_per_body);
    /// Positions by sample.
    std::vector<std::vector<Vec3>> follow(const Record& record) const;

private:
    struct Place {
        std::array<std::size_t, 4> node;
        std::array<Real, 4> weight;
    };
    std::vector<Place> places_;
};

/// Mean over time of the root mean square distance, over L.
Real mean_distance(const std::vector<std::vector<Vec3>>& a, const std::vector<std::vector<Vec3>>& b, Real length);

}  // namespace skerry::profiling
