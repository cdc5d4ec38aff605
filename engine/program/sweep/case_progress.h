// Displays the progress of a sweep: a bar on a terminal, otherwise occasional lines.
#pragma once

#include "engine/program/progress.h"

namespace skerry {

class CaseProgress {
public:
    /// Expects `count` cases. Everything goes to standard error. With `wanted` false nothing is ever shown.
    CaseProgress(bool wanted, int count);
    ~CaseProgress();
    CaseProgress(const CaseProgress&) = delete;
    CaseProgress& operator=(const CaseProgress&) = delete;

    /// Can be called at any rate. Shows a bar ten times a second, or lines after 1, 2, 4, ... s and finally every ten
    /// minutes.
    void show(int done, int running);

private:
    bool wanted_, bar_;
    int count_;
    Stopwatch watch_;
    double next_;  // wall time of the next display [s]
};

}  // namespace skerry
