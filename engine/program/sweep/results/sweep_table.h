// All cases of a sweep side by side: for people, for spreadsheets, for the page.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct SweepTable {
    const SweepFile& sweep;
    const Cases& cases;
    std::vector<CaseFile> files;  // by case
};

/// Names of all figures, in the order in which cases bring them.
std::vector<std::string> figure_names(const SweepTable& table);

/// A line a case with what says most, then why cases failed or were refused, and what they cost. Of many cases the
/// first ones.
std::string table_text(const SweepTable& table);

/// RFC 4180: parameters, status and all figures of each case; what is not known is empty.
std::string table_csv(const SweepTable& table);

/// A page for a browser, in one file: the same table, and any figure over any parameter. The drawing is its own.
std::string table_page(const SweepTable& table);

}  // namespace skerry
