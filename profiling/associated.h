// The associated law of friction beside Coulomb's, for profile_solvers.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

/// A table (CSV) of solutions under the associated law by several methods, each with its error by Coulomb's law.
class AssociatedTable {
public:
    /// `tolerances` from large to small, `cap`: seconds that a solve may take, about.
    AssociatedTable(const std::filesystem::path& file, std::vector<Real> tolerances, Real cap);

    void add(const ContactProblem& problem);

private:
    std::ofstream csv_;
    std::vector<Real> tolerances_;
    Real cap_;
};

}  // namespace skerry::profiling
