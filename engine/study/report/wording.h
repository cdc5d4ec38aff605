// Wording of variants and error bars in the reports of a study.
#pragma once

#include <string>
#include <vector>

#include "skerry/study.h"

namespace skerry {

/// Describes a variant, for example "mesh 1 level finer, steps x 0.5".
std::string variant_text(const StudyVariant& variant);

/// Numbers of a quantity as text. All have the same SI prefix, so that they can be compared.
struct QuantityText {
    std::string value, error, unit;  // error: empty if unknown, or if the value is "zero within" a number
    std::string parts;               // parts of the error, for example "mesh 2.6, step 0.1"; empty if zero or unknown
    std::string best, best_error;    // extrapolated value and its error; empty if unknown
    std::string share;               // error relative to the scale [%]; names the scale if the value differs from it
    std::string orders;              // for example "order 1.9 (2 expected)"; empty if unknown
};
QuantityText quantity_text(const StudyQuantity& quantity);

/// One line for all quantities with the same verdict and sentence; quantities with the verdict `known` have no line.
std::vector<std::string> verdict_lines(const StudyResult& result);
/// One line for all runs that have no result for the same reason.
std::vector<std::string> missing_lines(const StudyResult& result);

}  // namespace skerry
