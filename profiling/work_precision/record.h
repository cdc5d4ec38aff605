// Record of a run of a scene by any engine, and the distance between two runs.
#pragma once

#include <array>
#include <vector>

#include "profiling/work_precision/scene.h"

namespace skerry::profiling {

struct Record {
    bool finished = false;
    double seconds = 0;                         // CPU time of the steps, median of the repeats [s]
    double steps = 0;                           // number of steps taken
    Real step = 0;                              // [s]
    std::vector<std::vector<Vec3>> positions;   // of all nodes of all bodies, by sample [m]
    std::vector<std::vector<Vec3>> velocities;  // [m/s]
};

/// Mass-weighted distance of two runs of the same scene at one sample: sqrt(sum m |x - y|^2 / sum m) / L.
Real distance_at(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t sample);

/// Mean of distance_at over the first `samples` samples. It is an L1 norm in time, so an impact that comes a little
/// late counts in proportion to its delay. Infinite if one of the runs has fewer samples.
Real mean_distance(const PrecisionScene& scene, const Record& a, const Record& b, std::size_t samples);

/// Material points that are identical on every mesh of a scene. Their positions are interpolated in the tetrahedra that
/// hold them.
class Probes {
public:
    Probes(const PrecisionScene& scene, int points_per_body);
    /// Returns the positions of the points by sample.
    std::vector<std::vector<Vec3>> follow(const Record& record) const;

private:
    struct Place {
        std::array<std::size_t, 4> node;
        std::array<Real, 4> weight;
    };
    std::vector<Place> places_;
};

/// Mean over time of the root mean square distance of the points, divided by `length`.
Real mean_distance(const std::vector<std::vector<Vec3>>& a, const std::vector<std::vector<Vec3>>& b, Real length);

}  // namespace skerry::profiling
