// Replaces siconos.cpp where the package is missing.
#include "profiling/siconos.h"

namespace skerry::profiling {

struct SiconosProblem::Data {};

SiconosProblem::SiconosProblem(const ContactProblem&) {}
SiconosProblem::~SiconosProblem() = default;

SiconosSolution SiconosProblem::solve(std::size_t, Real, Index) {
    return {};
}

const std::vector<SiconosVariant>& siconos_variants() {
    static const std::vector<SiconosVariant> none;
    return none;
}

}  // namespace skerry::profiling
