// Table of profile_solvers for the associated law of friction, in comparison with Coulomb's law.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

/// CSV table of solutions under the associated law by several methods. Each row also has the error of the solution by
/// Coulomb's law.
class AssociatedTable {
public:
    /// `tolerances` are sorted from large to small. `cap` is the approximate time limit of one solve [s].
    AssociatedTable(const std::filesystem::path& file, std::vector<Real> tolerances, Real cap);

    void add(const ContactProblem& problem);

private:
    std::ofstream csv_;
    std::vector<Real> tolerances_;
    Real cap_;
};

}  // namespace skerry::profiling
