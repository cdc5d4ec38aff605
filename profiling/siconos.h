// Solution of the same problems by Siconos, where its package is installed. This header uses none of its types.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

struct SiconosSolution {
    std::vector<Vec3> reaction;  // [N s]
    double seconds = 0;
    Index iterations = 0;
    bool finished = false;  // Siconos reports that it reached the requested tolerance
};

/// A problem in the storage formats of Siconos' solvers. Building them is not timed.
class SiconosProblem {
public:
    explicit SiconosProblem(const ContactProblem& problem);
    ~SiconosProblem();

    /// Solves from r = 0 with the variant at this index of siconos_variants(). It is repeated and timed by timed()
    /// (measure.h). The options of a solver are created anew for each run, outside of the timing.
    SiconosSolution solve(std::size_t variant, Real tolerance, Index max_iterations);

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

struct SiconosVariant {
    std::string name;
    Index most_contacts;     // larger problems are skipped, since they take too much time or memory
    Index first_iterations;  // iterations of the run that measures the cost of an iteration
};

/// All variants; empty if the program was built without Siconos.
const std::vector<SiconosVariant>& siconos_variants();

}  // namespace skerry::profiling
