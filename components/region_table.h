// Contact regions of this step: independent frictional contact problems.
#pragma once

#include <cstdint>

#include "components/column.h"
#include "components/ragged.h"
#include "components/types.h"

namespace skerry {

enum class RegionStatus : std::uint8_t { converged, certified, iteration_limit, not_finite };

/// One row per region, numbered by its first contact.
struct RegionTable {
    Ragged<Index> contacts;    // rows of ContactTable, ascending
    Column<Index> iterations;  // sweeps; 0 when the warm start already solves it
    Column<Real> error;        // e_nat, methods.md 2.1
    Column<RegionStatus> status;
    Column<Real> dissipated;  // J, taken out by its contacts in this step
    Column<Index> order;      // regions by predicted cost, largest first, ties by number
    bool independent = true;  // no two regions share a moving node; false only from paper_algorithm_1: then solved one by one

    std::size_t size() const { return contacts.size(); }
    void for_each_column(auto&& visit) {
        visit("contacts.offset", contacts.offset);
        visit("contacts.item", contacts.item);
        visit("iterations", iterations);
        visit("error", error);
        visit("status", status);
        visit("dissipated", dissipated);
        visit("order", order);
    }
};

}  // namespace skerry
