// Records the probes of a scene: when parts of bodies stick and when they slide.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

struct ProbeRecord {
    std::string name;
    Real stick_time = 0, slide_time = 0, open_time = 0;  // [s]
    Real slide_alone_time = 0;                           // time during which no other probe slides [s]
    int changes = 0;                                     // changes between sticking and sliding
    Real max_slip = 0;                                   // largest mean over the probe's closed contacts [m/s]
    Real slip_distance = 0;                              // time integral of that mean slip [m]
    Real max_von_mises = 0;                              // largest stress at the probe's nodes [Pa]
    std::vector<Real> time;                              // times of the samples [s]
    std::vector<int> sticking, sliding;                  // numbers of contacts
    std::vector<Real> slip;                              // mean over closed contacts [m/s]
    std::vector<Real> von_mises;                         // largest value at the probe's nodes [Pa]
};

class ProbeRecorder {
public:
    explicit ProbeRecorder(const Scene& scene);
    /// Counts the contacts of the last step and evaluates the stress. The sample stands for the `seconds` since the
    /// previous one.
    void sample(const World& world, Real seconds);
    const std::vector<ProbeRecord>& records() const { return records_; }
    /// State that a recorder of the same probes needs to resume; go_on() restores it. go_on() throws nlohmann's
    /// exceptions, and std::out_of_range for other probes.
    Json saved() const;
    void go_on(const Json& saved);

private:
    enum class State { open, stick, slide };
    struct Tracked {
        BodyHandle body;
        std::vector<char> inside;  // flag per local node
        State last_closed = State::open;
        std::size_t stressed = 0;                   // index in `stressed_` of the body with the probe's nodes
        std::vector<std::size_t> stressed_nodes{};  // positions of the probe's nodes in that entry
    };
    /// Nodes of all probes of a body. Their stress is evaluated in one call, because each call searches for
    /// neighbours.
    struct Stressed {
        BodyHandle body;
        std::vector<Index> nodes{};  // local numbers
    };

    std::vector<Tracked> tracked_;
    std::vector<Stressed> stressed_;
    std::vector<ProbeRecord> records_;
};

Json to_json(const ProbeRecord& record);
/// Reads all members except the name.
void from_json(const Json& json, ProbeRecord& record);

}  // namespace skerry
