// Follows the probes of a scene: which parts of bodies stick and which slide, and when.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/place.h"
#include "skerry/scene.h"

namespace skerry {

struct ProbeRecord {
    std::string name;
    Real stick_time = 0, slide_time = 0, open_time = 0;  // s
    Real slide_alone_time = 0;                           // s, while no other probe slides
    int changes = 0;                                     // between sticking and sliding
    Real max_slip = 0;                                   // m/s, mean over the probe's closed contacts
    Real slip_distance = 0;                              // m, integral of that mean
    Real max_von_mises = 0;                              // Pa, of the probe's nodes
    std::vector<Real> time;                              // s, of the samples
    std::vector<int> sticking, sliding;                  // contacts
    std::vector<Real> slip;                              // m/s
    std::vector<Real> von_mises;                         // Pa, largest of the probe's nodes
};

class ProbeRecorder {
public:
    explicit ProbeRecorder(const Scene& scene);
    /// Counts the contacts of the last step, which stand for the `seconds` since the sample before, and looks at the
    /// stress.
    void sample(const World& world, Real seconds);
    const std::vector<ProbeRecord>& records() const { return records_; }
    /// All that a recorder of the same probes needs to go on, and going on from it. Throws nlohmann's exceptions, and
    /// std::out_of_range for other probes.
    Json saved() const;
    void go_on(const Json& saved);

private:
    enum class State { open, stick, slide };
    struct Tracked {
        BodyHandle body;
        std::vector<char> inside;  // by local node
        State last_closed = State::open;
        std::size_t stressed = 0;                   // which of `stressed_` has its nodes,
        std::vector<std::size_t> stressed_nodes{};  // and where
    };
    /// The nodes of all probes of a body, whose stress is found at once: what is around them is looked for each time.
    struct Stressed {
        BodyHandle body;
        std::vector<Index> nodes{};  // local
    };

    std::vector<Tracked> tracked_;
    std::vector<Stressed> stressed_;
    std::vector<ProbeRecord> records_;
};

Json to_json(const ProbeRecord& record);
/// All but the name.
void from_json(const Json& json, ProbeRecord& record);

}  // namespace skerry
