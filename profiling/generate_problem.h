// Contact problems made by rule, of any size and difficulty: sheets of nodes that lie on each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

/// Sheets of nodes one above the other. Every node inside a sheet touches the triangle of the neighbouring sheet under
/// or above it.
struct SheetSettings {
    Index sheets = 2;
    Index nodes = 12;      // along an edge of a sheet
    Index coarse = 1;      // the upper of two sheets has so many times longer edges
    bool stacked = false;  // all sheets fall on the lowest, which cannot move; else the upper strikes the others
    Real mass_ratio = 1;   // of odd sheets to even ones
    Real tilt = 0.05;      // normals are off the vertical by up to this much in each component
    Real friction = 0.5;
    std::uint64_t seed = 1;
};

/// Those contacts that can move something.
LumpedContacts generate_sheets(const SheetSettings& settings);

struct NamedContacts {
    std::string name;
    LumpedContacts contacts;
};

/// The generated problems of profile_solvers; `quick` leaves out the largest.
std::vector<NamedContacts> generate_problems(bool quick);

}  // namespace skerry::profiling
