// How far a sweep is: a bar on a terminal, lines now and then anywhere else.
#pragma once

#include "engine/program/progress.h"

namespace skerry {

class CaseProgress {
public:
    /// `count` cases are to be run. All goes to standard error; `wanted` false: nothing is ever shown.
    CaseProgress(bool wanted, int count);
    ~CaseProgress();
    CaseProgress(const CaseProgress&) = delete;
    CaseProgress& operator=(const CaseProgress&) = delete;

    /// As often as anyone wants: a bar ten times a second, lines after 1, 2, 4, ... s and in the end every ten minutes.
    void show(int done, int running);

private:
    bool wanted_, bar_;
    int count_;
    Stopwatch watch_;
    double next_;  // s of wall time, when to show something again
};

}  // namespace skerry
