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
    // error divided by StudyQuantity::scale [%]; also names the scale, unless it is close to the value
    std::string share;
    std::string orders;  // for example "order 1.9 (2 expected)"; empty if unknown
};
QuantityText quantity_text(const StudyQuantity& quantity);

/// Returns one line for each group of quantities with the same verdict and sentence. Quantities with the verdict
/// `known` have no line.
std::vector<std::string> verdict_lines(const StudyResult& result);
/// Returns one line for each group of runs that have no result for the same reason.
std::vector<std::string> missing_lines(const StudyResult& result);

}  // namespace skerry
