// All cases of a sweep side by side: as text for people, as CSV for spreadsheets and as a web page.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct SweepTable {
    const SweepFile& sweep;
    const Cases& cases;
    std::vector<CaseFile> files;  // one per case
};

/// Names of all figures, in order of their first appearance.
std::vector<std::string> figure_names(const SweepTable& table);

/// One line for each case with the most important figures, then the reasons of failed and refused cases, and the total
/// cost. Long lists are cut.
std::string table_text(const SweepTable& table);

/// Table as RFC 4180: parameters, status and all figures of each case. Unknown values are empty.
std::string table_csv(const SweepTable& table);

/// Web page in one file: the table, and a plot of any figure over any parameter. The page draws without external
/// libraries.
std::string table_page(const SweepTable& table);

}  // namespace skerry
