// Replacement for engine/live if SKERRY_LIVE=OFF. The constructor throws SceneError, so there is never a LiveView whose
// other functions could be called.
#include "skerry/live.h"
#include "engine/absent/refuse_absent.h"

namespace skerry {

struct LiveView::Impl {};

LiveView::LiveView(World&, const LiveSettings&) {
    refuse_absent("LiveView", "SKERRY_LIVE");
}
LiveView::~LiveView() = default;
LiveView::LiveView(LiveView&&) noexcept = default;
LiveView& LiveView::operator=(LiveView&&) noexcept = default;
std::string LiveView::address() const {
    return {};
}
void LiveView::sync(World&) {}
Real LiveView::due(World&) {
    return 0;
}
bool LiveView::between_steps(const World&) {
    return true;
}
void LiveView::fail(const std::string&) {}
void LiveView::refuse_resets(const std::string&) {}
void LiveView::run(World&, const std::function<bool()>&, const std::function<void(const std::string&)>&) {}
void LiveView::close() {}
bool LiveView::is_open() const {
    return false;
}
bool LiveView::playing() const {
    return false;
}
int LiveView::clients() const {
    return 0;
}
std::uint64_t LiveView::frames_sent() const {
    return 0;
}
std::uint64_t LiveView::frames_dropped() const {
    return 0;
}
std::uint64_t LiveView::resets() const {
    return 0;
}

}  // namespace skerry
