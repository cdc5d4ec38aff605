// Siconos' solvers of the same problems, when its package is there. This header knows none of its types.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

struct SiconosSolution {
    std::vector<Vec3> reaction;  // N s
    double seconds = 0;
    Index iterations = 0;
    bool finished = false;  // Siconos itself says that it reached what it was asked for
};

/// A problem in the storages that Siconos' solvers ask for, made beforehand: none of it is timed.
class SiconosProblem {
public:
    explicit SiconosProblem(const ContactProblem& problem);
    ~SiconosProblem();

    /// Solves from r = 0 with the variant of this number (siconos_variants), repeated and timed as `timed` does it. The
    /// options of a solver are made anew for each run, outside of the timing.
    SiconosSolution solve(std::size_t variant, Real tolerance, Index max_iterations);

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

struct SiconosVariant {
    std::string name;
    Index most_contacts;     // larger problems would take it more time or memory than the comparison has
    Index first_iterations;  // of the run that finds out what an iteration costs
};

/// All variants; none when the program was built without Siconos.
const std::vector<SiconosVariant>& siconos_variants();

}  // namespace skerry::profiling
