// Records for each contact probe of a scene when it sticks and when it slides. Such a probe is a set of nodes of a
// body.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

struct ProbeRecord {
    std::string name;
    Real stick_time = 0, slide_time = 0, open_time = 0;  // time of sticking, of sliding and without contact [s]
    Real slide_alone_time = 0;           // time during which this probe slides and no other probe does [s]
    int changes = 0;                     // changes between sticking and sliding, also with an open time in between
    Real max_slip = 0;                   // largest value of `slip` [m/s]
    Real slip_distance = 0;              // time integral of `slip` [m]
    Real max_von_mises = 0;              // largest value of `von_mises` [Pa]
    std::vector<Real> time;              // times of the samples [s]
    std::vector<int> sticking, sliding;  // numbers of sticking and sliding contacts in each sample
    std::vector<Real> slip;              // mean slip speed of the closed contacts in each sample [m/s]
    std::vector<Real> von_mises;         // largest von Mises stress at the nodes of the probe in each sample [Pa]
};

class ProbeRecorder {
public:
    explicit ProbeRecorder(const Scene& scene);
    /// Takes a sample of each probe: counts its contacts in the last step and evaluates its stress. `seconds` is the
    /// time since the previous sample [s].
    void sample(const World& world, Real seconds);
    const std::vector<ProbeRecord>& records() const { return records_; }
    /// saved() returns the state of the recorder for a checkpoint. go_on() restores it in a recorder of the same
    /// probes; it throws std::out_of_range if the probes differ, and an exception of nlohmann::json if the JSON is
    /// invalid.
    Json saved() const;
    void go_on(const Json& saved);

private:
    enum class State { open, stick, slide };
    struct Tracked {
        BodyHandle body;
        std::vector<char> inside;  // for each node of the body: nonzero if the node belongs to the probe
        State last_closed = State::open;
        std::size_t stress_row = 0;              // index in `stress_nodes_` of the probe's body
        std::vector<std::size_t> stress_rows{};  // indices of the probe's nodes in StressNodes::nodes
    };
    /// A body, and the nodes of all probes on this body. The stress of these nodes is evaluated in one call, because
    /// each call has to find the tetrahedra around the nodes.
    struct StressNodes {
        BodyHandle body;
        std::vector<Index> nodes{};  // node numbers within the body
    };

    std::vector<Tracked> tracked_;
    std::vector<StressNodes> stress_nodes_;
    std::vector<ProbeRecord> records_;
};

Json to_json(const ProbeRecord& record);
/// Reads all members of a record except its name, which the constructor of ProbeRecorder sets.
void from_json(const Json& json, ProbeRecord& record);

}  // namespace skerry
