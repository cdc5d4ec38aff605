// Tables in CSV (RFC 4180).
#pragma once

#include <string>
#include <vector>

namespace skerry {

/// Formats a number for CSV with so many digits that reading it gives the same number. Whole numbers below 1e15 have no
/// decimal point. Returns an empty text if the number is not finite.
std::string csv_number(double value);

/// Adds a line to a table. Cells with special characters are put in quotes.
void add_csv_line(const std::vector<std::string>& cells, std::string& csv);

}  // namespace skerry
