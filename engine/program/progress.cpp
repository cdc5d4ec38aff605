#include "engine/program/progress.h"

#include <unistd.h>

#include <cstdio>
#include <string>

namespace skerry {

namespace {

constexpr double refresh_interval = 0.1;  // s
constexpr int bar_width = 24;             // characters

}  // namespace

Progress::Progress(bool wanted, double seconds) : shown_(wanted && isatty(STDERR_FILENO) != 0), seconds_(seconds) {}

Progress::~Progress() {
    if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(double time) {
    if (!shown_) return;
    const double wall = watch_.seconds();
    if (last_ >= 0 && wall - last_ < refresh_interval) return;
    last_ = wall;
    const double share = time < seconds_ ? time / seconds_ : 1;
    const int filled = static_cast<int>(share * bar_width);
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                            std::string(static_cast<std::size_t>(bar_width - filled), '.');
    std::fprintf(stderr, "\r\033[K[%s] %3.0f %%  %.2f of %.4g s", bar.c_str(), 100 * share, time, seconds_);
    if (share > 0 && wall > 0)
        std::fprintf(stderr, "  %.2f x real time  %.0f s left", time / wall, wall * (1 - share) / share);
    std::fflush(stderr);
}

}  // namespace skerry
