#include "engine/program/sweep/case_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "engine/output/number_text.h"

namespace skerry {

namespace {

constexpr double bar_interval = 0.1;      // time between two updates of the bar [s]
constexpr double first_line_after = 1;    // wall time of the first line, and shortest time between two lines [s]
constexpr double longest_interval = 600;  // longest time between two lines [s]

}  // namespace

CaseProgress::CaseProgress(bool visible, const char* kind)
    : visible_(visible), bar_(visible && isatty(STDERR_FILENO) != 0), kind_(kind), next_(bar_ ? 0 : first_line_after) {}

CaseProgress::~CaseProgress() {
    if (bar_) clear_bar();
}

void CaseProgress::show(int done, int running, int count, double fraction) {
    const double wall = watch_.seconds();
    if (!visible_ || wall < next_) return;
    std::string text = std::to_string(done) + " of " + std::to_string(count) + " " + kind_ + " done, " +
                       std::to_string(running) + " running";
    if (fraction > 0) text += ", about " + duration_text(wall * (1 - fraction) / fraction) + " left";
    if (bar_)
        std::fprintf(stderr, "\r\033[K%s %s", bar_text(fraction).c_str(), text.c_str());
    else
        std::fprintf(stderr, "skerry: after %s: %s\n", duration_text(wall).c_str(), text.c_str());
    std::fflush(stderr);
    next_ = bar_ ? wall + bar_interval : wall + std::clamp(wall, first_line_after, longest_interval);
}

}  // namespace skerry
