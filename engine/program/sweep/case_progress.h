// Displays the progress of the runs of a sweep or a study: as a bar on a terminal, otherwise as a line from time to
// time.
#pragma once

#include "engine/program/progress.h"

namespace skerry {

class CaseProgress {
public:
    /// `kind`: name of the items in the plural, for example "cases". If `visible` is false, nothing is displayed. All
    /// output goes to standard error.
    CaseProgress(bool visible, const char* kind);
    ~CaseProgress();
    CaseProgress(const CaseProgress&) = delete;
    CaseProgress& operator=(const CaseProgress&) = delete;

    /// Displays the progress if the last display was long enough ago: the bar ten times a second, lines after 1, 2, 4,
    /// ... s and later every ten minutes. `done`, `running` and `count` are numbers of items, `fraction` is the share
    /// of the work that is done.
    void show(int done, int running, int count, double fraction);

private:
    bool visible_, bar_;
    const char* kind_;
    Stopwatch watch_;
    double next_;  // wall time of the next display [s]
};

}  // namespace skerry
