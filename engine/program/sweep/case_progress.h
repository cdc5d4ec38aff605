// Displays the progress of a sweep: as a bar on a terminal, otherwise as a line from time to time.
#pragma once

#include "engine/program/progress.h"

namespace skerry {

class CaseProgress {
public:
    /// `count` is the number of cases. If `wanted` is false, nothing is displayed. All output goes to standard error.
    CaseProgress(bool wanted, int count);
    ~CaseProgress();
    CaseProgress(const CaseProgress&) = delete;
    CaseProgress& operator=(const CaseProgress&) = delete;

    /// Displays the progress if the last display was long enough ago: the bar ten times a second, lines after 1, 2, 4,
    /// ... s and later every ten minutes. `done` and `running` are numbers of cases.
    void show(int done, int running);

private:
    bool wanted_, bar_;
    int count_;
    Stopwatch watch_;
    double next_;  // wall time of the next display [s]
};

}  // namespace skerry
