// Generated contact problems of any size and difficulty: sheets of nodes that lie on each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "skerry/problem.h"

namespace skerry::profiling {

/// Sheets of nodes one above the other. Every interior node of a sheet touches a triangle of each neighbouring sheet,
/// above and below it.
struct SheetSettings {
    Index sheets = 2;
    Index nodes = 12;      // along an edge of an odd-numbered sheet
    Index coarse = 1;      // edge length of odd-numbered sheets over that of even-numbered ones
    bool stacked = false;  // true: all sheets fall onto sheet 0, which is fixed; false: odd sheets strike even ones
    Real mass_ratio = 1;   // mass per area of odd sheets over that of even ones
    Real tilt = 0.05;      // largest deviation of each component of a normal from the vertical
    Real friction = 0.5;
    std::uint64_t seed = 1;
};

/// Generates the sheets. Contacts without a node that can move are left out.
LumpedContacts generate_sheets(const SheetSettings& settings);

struct NamedContacts {
    std::string name;
    LumpedContacts contacts;
};

/// The generated problems of profile_solvers. `quick` leaves out the large ones.
std::vector<NamedContacts> generate_problems(bool quick);

}  // namespace skerry::profiling
