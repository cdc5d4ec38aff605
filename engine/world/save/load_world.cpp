#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "engine/hdf5/hdf5_file.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/save/checks.h"
#include "engine/world/save/file_head.h"
#include "engine/world/save/list_state.h"
#include "engine/world/save/world_file.h"
#include "engine/world/state_hash.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

/// Columns in which a number may be infinite: bounds that nothing has, and the lanes that are left over.
bool may_be_infinite(std::string_view path) {
    constexpr std::array<std::string_view, 18> paths{"/watch/step",
                                                     "/watch/look/in_frame",
                                                     "/watch/look/highest",
                                                     "/tetrahedra/altitude",
                                                     "/tetrahedra/uninverted_until",
                                                     "/bodies/uninverted_until",
                                                     "/bodies/rest_step",
                                                     "/bodies/stable_step",
                                                     "/bodies/cluster_step",
                                                     "/bodies/travel",
                                                     "/colliders/travel",
                                                     "/pairs/valid_until",
                                                     "/pairs/candidates/asleep_until",
                                                     "/search/body_valid_until",
                                                     "/search/collider_valid_until",
                                                     "/joints/lower",
                                                     "/joints/upper",
                                                     "/joints/motor"};
    return std::find(paths.begin(), paths.end(), path) != paths.end();
}

/// The archive that reads.
class Reader {
public:
    explicit Reader(const Hdf5File& file) : file_(file) {}

    template <class T>
    void column(const std::string& path, Column<T>& column) {
        rows<T>(path, [&](std::size_t count) {
            column.resize(count);
            return column.data();
        });
    }
    template <class T>
    void value(const std::string& path, T& value) {
        rows<T>(path, [&](std::size_t count) {
            if (count != 1) file_.complain(path, std::to_string(count) + " rows", "one");
            return &value;
        });
    }

private:
    template <class T, class Place>
    void rows(const std::string& path, Place&& place) {
        if constexpr (HasMembers<T>) {
            std::size_t count = 0;
            bool first = true;
            std::apply([&](const auto&... member) { (members(path, place, member, count, first), ...); },
                       MembersOf<T>::list());
        } else {
            using Number = typename NumbersOf<T>::type;
            constexpr std::size_t width = NumbersOf<T>::count;
            Number* numbers = nullptr;
            std::size_t count = 0;
            file_.read_rows(path, hdf5_type<Number>(), width, [&](std::size_t found) -> void* {
                count = found;
                return numbers = reinterpret_cast<Number*>(place(found));
            });
            for (std::size_t i = 0; i < count * width; ++i) check<T>(path, numbers[i], i / width);
        }
    }
    /// The first member makes room for all.
    template <class S, class T>
    void members(const std::string& path, auto& place, const Member<S, T>& member, std::size_t& count, bool& first) {
        const std::string of_member = path + "/" + member.name;
        std::unique_ptr<T[]> values;
        std::size_t found = 0;
        rows<T>(of_member, [&](std::size_t wanted) {
            found = wanted;
            values = std::make_unique<T[]>(wanted);
            return values.get();
        });
        if (!first && found != count) file_.complain(of_member, std::to_string(found) + " rows", std::to_string(count));
        count = found;
        first = false;
        S* const into = place(count);
        for (std::size_t i = 0; i < count; ++i) into[i].*member.place = values[i];
    }
    template <class T>
    void check(const std::string& path, auto number, std::size_t row) const {
        const auto refuse = [&](const std::string& expected) {
            file_.complain(path, std::to_string(number) + " at row " + std::to_string(row), expected);
        };
        if constexpr (std::is_same_v<decltype(number), Real>) {
            if (std::isnan(number) || (std::isinf(number) && !may_be_infinite(path))) refuse("finite numbers");
        } else if constexpr (value_count<T> > 0) {
            if (static_cast<std::uint64_t>(number) >= value_count<T>)
                refuse("0 to " + std::to_string(value_count<T> - 1));
        }
    }

    const Hdf5File& file_;
};

/// As the world had them, but for what runs it.
Settings settings_of(const Hdf5File& file, const LoadSettings& wanted, Reader& reader, SavedRows& saved) {
    Settings settings;
    list_settings(settings, saved, reader);
    if (saved.step_size != 0) settings.step_size = saved.step_size;
    try {
        validate(settings);
    } catch (const SceneError& error) {
        file.complain("/settings", error.what(), "settings that a world takes");
    }
    const std::span<const Backend> here = available_backends();
    if (std::find(here.begin(), here.end(), settings.backend) == here.end()) settings.backend = Backend::automatic;
    settings.backend = wanted.backend.value_or(settings.backend);
    settings.threads = wanted.threads.value_or(settings.threads);
    return settings;
}

/// What is not saved is made from what is.
void derive(const Hdf5File& file, const SavedRows& saved, WorldState& world) {
    Model& model = world.model;
    check_clock(file, world.clock, world.scratch.parameters.kick);
    check_model(file, model);
    put_records(saved, file, model);
    // laws that have no frame leave both as they are, and the step swaps them
    model.elements.rotation_next = model.elements.rotation;
    model.rebuild_outlines();
    model.derive_all();
    find_holders(model);
    model.note_rest();
    check_cache(file, model, world.cache);
    put_candidates(saved, file, model, world.cache.pairs);
    world.cache.search.memory.sphere.resize(model.bodies.slot.size());  // room that a broad search would make
    put_limits(saved, file, world.record.limits);
    put_start(saved, file, world.record);
    world.scratch.contacts = saved.contacts;
    check_contacts(file, model, world.scratch.contacts);
    check_resting_contacts(file, model, world.cache.resting);
}

void expect_hash(const Hdf5File& file, WorldState& world, Reader& reader) {
    std::uint64_t saved = 0;
    reader.value("/state_hash", saved);
    const std::uint64_t found = state_hash(world);
    char text[2][20];
    std::snprintf(text[0], sizeof text[0], "%016" PRIx64, found);
    std::snprintf(text[1], sizeof text[1], "%016" PRIx64, saved);
    if (found != saved) file.complain("/state_hash", text[1], text[0], "the hash of what the file holds");
}

}  // namespace

LoadedWorld load_world(const std::filesystem::path& path, const LoadSettings& settings, bool compare_hash) {
    check_head(path);
    const Hdf5File file(path, "a world that Skerry saved (HDF5)");
    Reader reader(file);
    SavedRows saved;
    LoadedWorld loaded{World(settings_of(file, settings, reader, saved)), {file.text_or_nothing("/note")}};
    WorldState& world = WorldAccess::state_of(loaded.world);
    list_state(world, saved, reader);
    derive(file, saved, world);
    if (compare_hash) expect_hash(file, world, reader);
    return loaded;
}

World World::load(const std::filesystem::path& file, const LoadSettings& settings) {
    return load_world(file, settings).world;
}

}  // namespace skerry
