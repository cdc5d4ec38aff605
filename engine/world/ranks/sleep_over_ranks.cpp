// Sleep of bodies that several ranks hold. Each rank stores only the contacts of its own pairs. So sets of touching
// bodies are joined over all ranks, and a body wakes on all its ranks if one of them wakes it. The ranks exchange such
// data only if reduce_findings shows that one of them needs it.
#include <algorithm>
#include <cstddef>
#include <span>

#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"
#include "systems/dynamics/motion/update_sleep.h"

namespace skerry {

namespace {

/// Bodies, with the ranks that hold them.
struct HeldBodies {
    std::span<const Index> world_row;              // by body: its row in the undivided world
    const std::vector<std::vector<int>>& holders;  // RankState
    std::span<const BodyKind> kind;                // BodyTable
    std::span<const std::uint8_t> asleep;
    std::span<const Real> still_time;  // [s]

    static HeldBodies bind(const Binder& binder, const RankState& ranks, const BodyTable& body) {
        return {.world_row = binder.read(ranks.world_row),
                .holders = binder.value(ranks.holders),
                .kind = binder.read(body.kind),
                .asleep = binder.read(body.asleep),
                .still_time = binder.read(body.still_time)};
    }
    bool is_shared(std::size_t body) const { return kind[body] == BodyKind::deformable && !holders[body].empty(); }
};

/// Length of the step, and the settings of sleep.
struct SleepStep {
    const SleepSettings& sleep;
    const Real& h;  // [s]

    static SleepStep bind(const Binder& binder, const StepParameters& parameters) {
        return {binder.value(parameters.sleep), binder.value(parameters.h)};
    }
};

template <class Row>
void copy(std::span<const Row> from, Column<Row>& to) {
    to.resize(from.size());
    std::ranges::copy(from, to.begin());
}

/// Lists the sleeping bodies that this rank wakes and other ranks hold too. Also notes whether a body that several
/// ranks hold may fall asleep in this step.
void find_wakes(const HeldBodies& bodies, const TouchInputs& touches, std::span<const std::uint8_t> pressed,
                std::span<const std::uint8_t> driven, const AttachmentTable& attachments, const SleepStep& step,
                RankSleep& memory, RankFindings& own_findings) {
    for (std::size_t b = 0; b < bodies.world_row.size(); ++b)
        own_findings.may_rest |=
            bodies.is_shared(b) && !bodies.asleep[b] && bodies.still_time[b] + step.h >= step.sleep.time;
    memory.woken.clear();
    if (std::ranges::none_of(bodies.asleep, [](std::uint8_t each) { return each != 0; })) return;
    copy(bodies.asleep, memory.asleep);
    copy(bodies.still_time, memory.still_time);
    // Links, such as joints, to awake bodies are left out: every rank that holds the bodies finds them itself.
    TouchInputs without_links = touches;
    without_links.linked_first = without_links.linked_second = {};
    if (!wake_bodies(without_links, pressed, driven, attachments.body, attachments.motion, memory.asleep,
                     memory.still_time))
        return;
    for (std::size_t b = 0; b < bodies.world_row.size(); ++b)
        if (bodies.is_shared(b) && bodies.asleep[b] && !memory.asleep[b]) memory.woken.push_back(bodies.world_row[b]);
    own_findings.wakes = !memory.woken.empty();
}

/// Marks in `pressed` the bodies that any rank wakes, so that wake_bodies wakes them on this rank.
void join_wakes(const HeldBodies& bodies, const RankSleep& memory, Column<std::uint8_t>& pressed,
                RankChannel& channel) {
    pressed.resize(bodies.world_row.size(), 0);
    for_each_gathered<Index>(*channel.ranks, memory.woken, [&](Index world_row) {
        if (const Index row = local_row(bodies.world_row, world_row); row != no_index) pressed[row] = 1;
    });
}

/// Joins sets of touching bodies that share a body, and marks the sets of this rank that must stay awake because of a
/// body of another rank.
void join_sets(const HeldBodies& bodies, SleepMemory& sets, RankSleep& memory, RankChannel& channel) {
    memory.members.clear();
    for (std::size_t b = 0; sets.any_ready && b < bodies.world_row.size(); ++b) {
        if (!bodies.is_shared(b)) continue;
        const Index root = sets.touching.root(static_cast<Index>(b));
        memory.members.push_back({bodies.world_row[b], root, sets.stays_awake[root]});
    }
    const std::span<const SetMember> own_members = memory.members;
    const std::vector<RankMessage> messages = channel.ranks->gather_everywhere(std::as_bytes(own_members));
    // Entry k of the union-find `joined` stands for the k-th member in the messages of all ranks.
    Index count = 0, last_world_row = -1;
    for (const RankMessage& message : messages)
        MailReader(message).take_all<SetMember>([&](const SetMember& member) {
            ++count;
            last_world_row = std::max(last_world_row, member.world_row);
        });
    memory.joined.start(static_cast<std::size_t>(count));
    memory.restless.assign(static_cast<std::size_t>(count), 0);
    memory.node_of_body.assign(static_cast<std::size_t>(last_world_row + 1), no_index);
    Index node = 0;
    for (const RankMessage& message : messages) {
        memory.node_of_set.clear();
        MailReader(message).take_all<SetMember>([&](const SetMember& member) {
            const auto set = static_cast<std::size_t>(member.set);
            if (memory.node_of_set.size() <= set) memory.node_of_set.resize(set + 1, no_index);
            for (Index* const known : {&memory.node_of_body[member.world_row], &memory.node_of_set[set]}) {
                if (*known == no_index) *known = node;
                memory.joined.join(*known, node);
            }
            memory.restless[node] = member.stays_awake != 0;
            ++node;
        });
    }
    for (Index n = 0; n < count; ++n)
        if (memory.restless[n]) memory.restless[memory.joined.root(n)] = 1;
    for (const SetMember& member : own_members)
        sets.stays_awake[member.set] |= memory.restless[memory.joined.root(memory.node_of_body[member.world_row])];
}

}  // namespace

void list_wakes(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    g.stage("ranks/find_wakes", find_wakes, inputs<HeldBodies>(w.ranks, w.model.bodies),
            inputs<TouchInputs>(w.scratch.contacts, w.model.links), read(w.scratch.pressed), read(w.scratch.driven),
            read(w.model.attachments), inputs<SleepStep>(w.scratch.parameters), make(w.ranks.sleep),
            make(w.ranks.own_findings), if_sleepy(w));
}

void list_joined_wakes(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    const auto if_any = only_if([](const bool& wakes) { return wakes; }, read(w.ranks.all_findings.wakes));
    g.stage("ranks/join_wakes", join_wakes, inputs<HeldBodies>(w.ranks, w.model.bodies), read(w.ranks.sleep),
            make(w.scratch.pressed), make(w.ranks.channel), if_taken(w), if_any);
}

void list_joined_sets(WorldState& w, TaskGraph& g) {
    if (!w.ranks.on()) return;
    const auto if_any = only_if([](const bool& may_rest) { return may_rest; }, read(w.ranks.all_findings.may_rest));
    g.stage("ranks/join_sets", join_sets, inputs<HeldBodies>(w.ranks, w.model.bodies), make(w.scratch.sleep_memory),
            make(w.ranks.sleep), make(w.ranks.channel), if_taken(w), if_any);
}

}  // namespace skerry
