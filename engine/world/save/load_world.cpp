#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <vector>

#include "engine/hdf5/hdf5_file.h"
#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/save/checks.h"
#include "engine/world/save/file_head.h"
#include "engine/world/save/list_state.h"
#include "engine/world/save/world_file.h"
#include "engine/world/state_hash.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

/// True for columns that may contain infinity. It stands for a bound that does not exist, or is the value in an unused
/// lane.
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

/// The archive (see list_state.h) that reads from a file.
class Reader final : public Archive {
public:
    explicit Reader(const Hdf5File& file) : file_(file) {}

    void column(const std::string& path, AnyColumn column) override {
        read(path, column.type(), [&](std::size_t count) {
            column.resize(count);
            return column.write();
        });
    }

private:
    // function that allocates memory for a number of rows and returns its address
    using Place = FunctionRef<std::byte*(std::size_t)>;

    void put_value(const std::string& path, void* value, const RowType& type) override {
        read(path, type, [&](std::size_t count) {
            if (count != 1) file_.complain(path, std::to_string(count) + " rows", "one row");
            return static_cast<std::byte*>(value);
        });
    }
    void read(const std::string& path, const RowType& type, Place place) const {
        if (type.members == nullptr)
            read_numbers(path, type, place);
        else
            read_members(path, type, place);
    }
    void read_numbers(const std::string& path, const RowType& type, Place place) const {
        const std::byte* rows = nullptr;
        std::size_t count = 0;
        file_.read_rows(path, hdf5_type(type.number), type.width, [&](std::size_t found) -> void* {
            count = found;
            std::byte* const room = place(found);
            rows = room;
            return room;
        });
        check(path, type, rows, count);
    }
    /// Reads a column of structs, one data set for each member. The size of the first data set determines the number of
    /// rows.
    void read_members(const std::string& path, const RowType& type, Place place) const {
        std::byte* rows = nullptr;
        std::size_t count = 0;
        bool first = true;
        for (const Member& member : type.members()) {
            const std::string of_member = path + "/" + member.name;
            const std::size_t bytes = member.type->bytes;
            std::vector<std::byte> values;
            std::size_t found = 0;
            read(of_member, *member.type, [&](std::size_t wanted) {
                found = wanted;
                values.resize(wanted * bytes);
                return values.data();
            });
            if (first) {
                count = found;
                rows = place(count);
                first = false;
            }
            if (found != count)
                file_.complain(of_member, std::to_string(found) + " rows",
                               std::to_string(count) + ", as many as the other members have");
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(rows + i * type.bytes + member.offset, values.data() + i * bytes, bytes);
        }
    }
    void check(const std::string& path, const RowType& type, const std::byte* rows, std::size_t count) const {
        if (type.number == NumberType::real)
            check_reals<Real>(path, type, rows, count);
        else if (type.number == NumberType::single)
            check_reals<float>(path, type, rows, count);
        else if (type.values > 0)
            check_values(path, type, rows, count);
    }
    template <class Number>
    void check_reals(const std::string& path, const RowType& type, const std::byte* rows, std::size_t count) const {
        const bool infinite = may_be_infinite(path);
        for (std::size_t i = 0; i < count * type.width; ++i) {
            Number number;
            std::memcpy(&number, rows + i * sizeof number, sizeof number);
            if (std::isnan(number) || (std::isinf(number) && !infinite))
                refuse(path, std::to_string(number), i / type.width, "finite numbers");
        }
    }
    void check_values(const std::string& path, const RowType& type, const std::byte* rows, std::size_t count) const {
        for (std::size_t i = 0; i < count * type.width; ++i) {
            const std::int64_t number = number_at(rows + i * bytes_of(type.number), type.number);
            if (static_cast<std::uint64_t>(number) >= type.values)
                refuse(path, std::to_string(number), i / type.width, "0 to " + std::to_string(type.values - 1));
        }
    }
    void refuse(const std::string& path, const std::string& found, std::size_t row, const std::string& expected) const {
        file_.complain(path, found + " at row " + std::to_string(row), expected);
    }

    const Hdf5File& file_;
};

/// Makes a world with the saved settings. The caller may replace the backend and the number of threads of the saved
/// world.
World world_of(const Hdf5File& file, const LoadSettings& wanted, Reader& reader, SavedRows& saved) {
    Settings settings;
    Tuning tuning;
    list_settings(settings, tuning, saved, reader);
    if (saved.step_size != 0) settings.step_size = saved.step_size;
    try {
        validate(settings);
        validate(tuning);
    } catch (const SceneError& error) {
        file.complain("/settings", std::string("invalid settings (") + error.what() + ")", "valid settings");
    }
    const std::span<const Backend> here = available_backends();
    if (std::find(here.begin(), here.end(), settings.backend) == here.end()) settings.backend = Backend::automatic;
    use(wanted, settings);
    return tuned_world(settings, tuning);
}

/// Checks the saved data, and computes all data of the world that are not saved.
void derive(const Hdf5File& file, const SavedRows& saved, WorldState& world) {
    Model& model = world.model;
    check_clock(file, world.clock, world.scratch.parameters.kick);
    check_model(file, model);
    put_records(saved, file, model);
    // If a material law has no rotated frame, a step writes neither rotation nor rotation_next, but swaps these two
    // columns. Their values must therefore be equal.
    model.elements.rotation_next = model.elements.rotation;
    model.rebuild_outlines();
    model.derive_all();
    // assumed at first, because the last force may have been removed just before saving; note_forces corrects it
    model.forced = true;
    note_forces(model);
    model.links_open = true;
    find_holders(model);
    model.note_rest();
    check_cache(file, model, world.cache);
    put_candidates(saved, file, model, world.cache.pairs);
    // this column is not saved; without this resize, only a search of all pairs would give it the right size
    world.cache.search.memory.sphere.resize(model.bodies.slot.size());
    put_limits(saved, file, world.record.limits);
    put_start(saved, file, world.record);
    put_self_crossings(saved, file, world.record);
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
    if (found != saved)
        file.complain("/state_hash", text[1], text[0] + std::string(", the hash of the contents of the file"));
}

}  // namespace

LoadedWorld load_world(const std::filesystem::path& path, const LoadSettings& settings, bool compare_hash) {
    check_head(path);
    const Hdf5File file(path, "a world that Skerry saved (HDF5)",
                        "the file is damaged or was edited; save the world again");
    Reader reader(file);
    SavedRows saved;
    LoadedWorld loaded{world_of(file, settings, reader, saved), {file.text_or_nothing("/note")}};
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
