#include "engine/program/checkpoint.h"

#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <utility>

#include "engine/base/complaint.h"
#include "engine/output/number_text.h"
#include "engine/world/save/world_file.h"

namespace skerry {

namespace {

[[noreturn]] void refuse_restart(const std::filesystem::path& file, const std::string& found,
                                 const std::string& expected, const std::string& hint = {}) {
    refuse_in(file.string(), "--restart", {}, found, expected, hint);
}

const char* const damaged = "the file is damaged or was edited; start the run again without --restart";

// Tolerance for rounding errors of summed times, as a fraction of the interval between checkpoints.
constexpr double slack = 1e-9;

double multiple_after(double time, double every) {
    return (std::floor(time / every + slack) + 1) * every;
}

template <class HandleType>
bool same_slots(const std::vector<HandleType>& a, const std::vector<HandleType>& b) {
    return std::ranges::equal(a, b, [](const HandleType& x, const HandleType& y) {
        return x.slot == y.slot && x.generation == y.generation;
    });
}

std::string counted(std::size_t count, const char* noun) {
    return std::to_string(count) + " " + noun;
}

/// Sets the world number in all handles of a probe. The handles then refer to the same objects of the world with this
/// number.
void rename_world(RecordedProbe& probe, std::uint32_t number) {
    const auto rename = [number](auto& handle) { handle.world = number; };
    std::visit(
        [&](auto& object) {
            if constexpr (requires { object.body; }) rename(object.body);
            if constexpr (requires { object.collider; }) rename(object.collider);
            if constexpr (requires { object.attachment; }) rename(object.attachment);
            if constexpr (requires { object.joint; }) rename(object.joint);
            if constexpr (requires { object.tie; }) rename(object.tie);
            if constexpr (requires { object.cable; }) rename(object.cable);
            if constexpr (requires { object.cavity; }) rename(object.cavity);
            if constexpr (requires { object.spring; }) rename(object.spring);
            if constexpr (requires { object.object; }) std::visit(rename, object.object);
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(object)>, BodyForceProbe>) {
                if (object.by) std::visit(rename, *object.by);
            } else if constexpr (requires { object.by; }) {
                if (object.by) rename(*object.by);
            }
        },
        probe.what);
}

}  // namespace

Json to_json(const RunMemory& memory) {
    return object_of({{"scene", memory.scene.string()},
                      {"assignments", memory.assignments},
                      {"seconds", memory.seconds},
                      {"frame_step", memory.frame_step},
                      {"samples", memory.samples},
                      {"probe_step", memory.probe_step},
                      {"frame", memory.frame},
                      {"sample", memory.sample},
                      {"seconds_wall", memory.seconds_wall},
                      {"peak_kinetic_energy", memory.peak_kinetic_energy},
                      {"probes", memory.probes}});
}

RunMemory memory_of(const std::filesystem::path& file, const std::string& text) {
    if (text.empty())
        refuse_restart(file, "a saved world that contains no state of a run",
                       "a file written by `skerry run --checkpoint`");
    RunMemory memory;
    try {
        const Json json = Json::parse(text);
        memory.scene = json.at("scene").get<std::string>();
        json.at("assignments").get_to(memory.assignments);
        json.at("seconds").get_to(memory.seconds);
        json.at("frame_step").get_to(memory.frame_step);
        json.at("samples").get_to(memory.samples);
        json.at("probe_step").get_to(memory.probe_step);
        json.at("frame").get_to(memory.frame);
        json.at("sample").get_to(memory.sample);
        json.at("seconds_wall").get_to(memory.seconds_wall);
        json.at("peak_kinetic_energy").get_to(memory.peak_kinetic_energy);
        memory.probes = json.at("probes");
    } catch (const std::exception& error) {
        refuse_restart(file, std::string("an unreadable state of a run (") + error.what() + ")",
                       "a file written by `skerry run --checkpoint`", damaged);
    }
    const bool good = memory.frame_step > 0 && std::isfinite(memory.frame_step) && memory.samples > 0 &&
                      memory.probe_step >= 0 && memory.frame >= 0 && memory.sample >= 0 &&
                      memory.sample < memory.samples;
    if (!good)
        refuse_restart(
            file,
            "frame " + std::to_string(memory.frame) + ", sample " + std::to_string(memory.sample) + " of " +
                std::to_string(memory.samples) + " and a frame step of " + Json(memory.frame_step).dump() + " s",
            "frame and sample numbers of at least 0, a sample number below the number of samples, and a positive "
            "frame step",
            damaged);
    return memory;
}

Restart read_restart(const std::filesystem::path& file, const LoadSettings& settings) {
    LoadedWorld loaded = load_world(file, settings);
    RunMemory memory = memory_of(file, loaded.note.text);
    return {std::move(loaded.world), std::move(memory)};
}

void put_in_place(const std::filesystem::path& file, World world, Scene& scene) {
    const char* const hint =
        "the scene has changed since the checkpoint was written; restore the scene, or start without --restart";
    const auto bodies = world.bodies(), of_scene = scene.world.bodies();
    if (!same_slots(bodies, of_scene))
        refuse_restart(file, counted(bodies.size(), "bodies in the checkpoint"),
                       "the " + counted(of_scene.size(), "bodies of the scene"), hint);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::string &name = world.name(bodies[b]), &name_in_scene = scene.world.name(of_scene[b]);
        const std::size_t found = world.positions(bodies[b]).size(),
                          expected = scene.world.positions(of_scene[b]).size();
        if (name != name_in_scene || found != expected)
            refuse_restart(file, "body \"" + name + "\" with " + counted(found, "nodes"),
                           "body \"" + name_in_scene + "\" with " + counted(expected, "nodes"), hint);
    }
    const auto colliders = world.colliders(), colliders_of_scene = scene.world.colliders();
    if (!same_slots(colliders, colliders_of_scene))
        refuse_restart(file, counted(colliders.size(), "colliders in the checkpoint"),
                       "the " + counted(colliders_of_scene.size(), "colliders of the scene"), hint);
    for (std::size_t c = 0; c < colliders.size(); ++c)
        if (world.name(colliders[c]) != scene.world.name(colliders_of_scene[c]))
            refuse_restart(file, "collider \"" + world.name(colliders[c]) + "\"",
                           "collider \"" + scene.world.name(colliders_of_scene[c]) + "\"", hint);
    // Handles of the replaced world are not valid in the new world, so the probes get handles of the new world.
    for (Probe& probe : scene.probes)
        probe.body = bodies[static_cast<std::size_t>(std::ranges::find(of_scene, probe.body) - of_scene.begin())];
    const std::uint32_t number = bodies.empty() && colliders.empty() ? 0
                                 : bodies.empty()                    ? colliders.front().world
                                                                     : bodies.front().world;
    for (RecordedProbe& probe : scene.recorded) rename_world(probe, number);
    scene.world = std::move(world);
}

CheckpointWriter::CheckpointWriter(std::filesystem::path file, double every, double time)
    : file_(std::move(file)), every_(every), next_(std::numeric_limits<double>::infinity()) {
    if (!file_.empty()) next_ = multiple_after(time, every_);
}

std::string CheckpointWriter::summary() const {
    return file_.string() + " (checkpoint for --restart, written " + std::to_string(written_) +
           (written_ == 1 ? " time)" : " times)");
}

bool CheckpointWriter::due(double time) const {
    return time >= next_ - slack * every_;
}

std::string CheckpointWriter::last_words() const {
    const std::string text =
        "skerry: the launcher ends the job, by order of the user or because another rank has failed; ";
    if (written_ == 0) return text + "there is no checkpoint of this run (--checkpoint FILE writes them)\n";
    return text + "to continue from the checkpoint at " + with_unit(last_, "s") + ": skerry run --restart " +
           file_.string() + "\n";
}

void CheckpointWriter::write(World* world, double time, const RunMemory& memory) {
    try {
        if (world != nullptr) {
            save_world(WorldAccess::state_of(*world), {to_json(memory).dump()}, file_);
            ++written_;
            last_ = time;
            failure_.clear();
        }
    } catch (const std::exception& error) {
        ++failed_;
        failure_ = error.what();
        std::fprintf(stderr, "skerry: the checkpoint at %g s could not be written: %s; the run continues\n", time,
                     error.what());
    }
    next_ = multiple_after(time, every_);
}

}  // namespace skerry
