// Report of a study, for people to read: a text and a web page.
#pragma once

#include <string>

#include "skerry/study.h"

namespace skerry {

/// Returns one line per quantity with its error bar, the verdicts, the runs that are missing, and the cheapest
/// settings. Long lists are cut; the page has them all.
std::string study_text(const StudyResult& result);

/// Returns a web page with a plot of error against CPU time, the time series with their error bars, and tables of all
/// quantities and runs. The page is one file that needs no other files.
std::string study_page(const StudyResult& result);

}  // namespace skerry
