// Table of all cases of a sweep: as text for people, as CSV for spreadsheets and as a web page.
#pragma once

#include <string>
#include <vector>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/results/case_result.h"

namespace skerry {

struct SweepTable {
    const SweepFile& sweep;
    const Cases& cases;
    std::vector<CaseFile> files;  // result file of each case
};

/// Returns the names of all numbers in CaseResult::figures, in the order of their first appearance.
std::vector<std::string> figure_names(const SweepTable& table);

/// Returns a table with one line per case and its most important numbers, then the error messages and warnings of the
/// cases, and the total CPU time. Long lists are cut.
std::string table_text(const SweepTable& table);

/// Returns a CSV table (RFC 4180) with parameters, status, all numbers, state hash, message and warnings of each case.
/// Cells of unknown values are empty.
std::string table_csv(const SweepTable& table);

/// Returns a web page with the table, and with a plot of any parameter or number against any other. The page is one
/// file and needs no other files.
std::string table_page(const SweepTable& table);

}  // namespace skerry
