// Commands that a browser sends to a live view.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "components/options.h"
#include "engine/output/collect_frame.h"
#include "skerry/world.h"

namespace skerry {

enum class LiveAction {
    seen,     // the browser has drawn frame `number` and all frames before it
    fields,   // the browser shows the fields in the list "names"; see LiveCommand::content
    play,     // go on
    pause,    // stop
    step,     // advance by one step, then pause
    reset,    // go back to the state at the start
    rate,     // set the simulated time per wall time to `value`
    gravity,  // switch gravity on or off, as `on` says
    slider,   // set slider `number` to `value`
    pull,     // pull `body` by `point` towards `to`
    move,     // move the target of the pull to `to`
    release,  // end the pull
};
template <>
struct EnumNames<LiveAction> {
    static constexpr std::array<std::pair<LiveAction, std::string_view>, 12> table{{
        {LiveAction::seen, "seen"},
        {LiveAction::fields, "fields"},
        {LiveAction::play, "play"},
        {LiveAction::pause, "pause"},
        {LiveAction::step, "step"},
        {LiveAction::reset, "reset"},
        {LiveAction::rate, "rate"},
        {LiveAction::gravity, "gravity"},
        {LiveAction::slider, "slider"},
        {LiveAction::pull, "pull"},
        {LiveAction::move, "move"},
        {LiveAction::release, "release"},
    }};
};

/// A command. Members that are not in its JSON text keep their defaults; the action does not use them.
struct LiveCommand {
    LiveAction action = LiveAction::pause;
    std::uint64_t client = 0;  // number of the browser
    std::uint64_t number = 0;  // number of a frame from 1, or index of a slider
    Real value = 0;
    bool on = false;
    FrameContent content = FrameContent::motion;   // least FrameContent that contains the fields shown by the browser
    std::uint64_t body_number = 0;                 // index of the body in LiveEncoder::bodies of this browser
    BodyHandle body{};                             // handle of this body, set by LiveHub::receive
    Vec3 point = Vec3::Zero(), to = Vec3::Zero();  // pulled point and its target [m]
};

/// Reads a command such as {"do":"rate","value":0.5}. Throws SceneError that names the member at fault.
LiveCommand read_command(std::string_view text);

}  // namespace skerry
