#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/world/edit/rigid_bodies.h"
#include "engine/world/save/checks.h"
#include "engine/world/save/list_state.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/save/world_file.h"
#include "engine/world/state_hash.h"
#include "engine/world/step/step.h"
#include "engine/world/validate.h"

namespace skerry {

namespace {

std::string kind_of_array(NumberType number, std::size_t width) {
    return (width == 1 ? "a column of " : "rows of " + std::to_string(width) + " ") +
           (is_real(number) ? "reals" : "integers") + " of " + std::to_string(bytes_of(number)) + " bytes";
}

/// The archive (see list_state.h) that reads from a file.
class Reader final : public Archive {
public:
    explicit Reader(const SavedFile& file) : file_(file), unread_(file.arrays()) {}

    void column(const std::string& path, AnyColumn column) override {
        const std::size_t rows = rows_of(path, column.type());
        column.resize(rows);
        read(path, column.type(), column.write(), column.type().bytes, rows);
    }
    /// Refuses a file with arrays that were not read.
    void require_end() const {
        if (!unread_.empty())
            file_.complain(unread_.begin()->first, "an array", "no array of this name in the present version");
    }

private:
    void put_value(const std::string& path, void* value, const RowType& type) override {
        read(path, type, static_cast<std::byte*>(value), type.bytes, 1);
    }
    const SavedArray& array(const std::string& path, const RowType& type) const {
        const auto found = unread_.find(path);
        const std::string expected = kind_of_array(type.number, type.width);
        if (found == unread_.end()) file_.complain(path, "nothing", expected);
        const SavedArray& array = found->second;
        if (array.number != type.number || array.width != type.width)
            file_.complain(path, kind_of_array(array.number, array.width), expected);
        return array;
    }
    /// Returns the number of rows of a column. For a column of structs, this is the number of rows of the first member.
    std::size_t rows_of(const std::string& path, const RowType& type) const {
        if (type.members == nullptr) return array(path, type).rows;
        const Member& first = type.members().front();
        return rows_of(path + "/" + first.name, *first.type);
    }
    /// Reads rows into memory, in which the distance between two rows is `stride` [bytes].
    void read(const std::string& path, const RowType& type, std::byte* to, std::size_t stride, std::size_t rows) {
        if (type.members != nullptr) {
            for (const Member& member : type.members())
                read(path + "/" + member.name, *member.type, rows == 0 ? nullptr : to + member.offset, stride, rows);
            return;
        }
        const SavedArray& found = array(path, type);
        if (found.rows != rows)
            file_.complain(path, std::to_string(found.rows) + " rows",
                           rows == 1 ? "one row" : std::to_string(rows) + ", as many as the other members have");
        check(path, type, found.bytes.data(), rows);
        copy_strided(found.bytes.data(), found.row_bytes(), to, stride, found.row_bytes(), rows);
        unread_.erase(path);
    }
    void check(const std::string& path, const RowType& type, const std::byte* rows, std::size_t count) const {
        if (const auto wrong = find_wrong_real(path, type, rows, type.width * bytes_of(type.number), count))
            refuse(path, wrong->found, wrong->row, "finite numbers");
        if (type.values > 0 && !is_real(type.number)) check_values(path, type, rows, count);
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

    const SavedFile& file_;
    std::map<std::string, SavedArray> unread_;
};

/// Makes a world with the saved settings. `load_settings` may replace the backend and the number of threads. A saved
/// backend that this program lacks becomes `automatic`.
World world_of(const SavedFile& file, const LoadSettings& load_settings, Reader& reader, SavedRows& saved) {
    Settings settings;
    Tuning tuning;
    list_settings(settings, tuning, saved, reader);
    if (saved.step_size != 0) settings.step_size = saved.step_size;
    try {
        validate(settings);
        validate(tuning);
    } catch (const SceneError& error) {
        file.complain("settings", std::string("invalid settings (") + error.what() + ")", "valid settings");
    }
    const std::span<const Backend> here = available_backends();
    if (std::find(here.begin(), here.end(), settings.backend) == here.end()) settings.backend = Backend::automatic;
    use(load_settings, settings);
    return tuned_world(settings, tuning);
}

/// Checks the saved data, and computes all data of the world that are not saved.
void derive(const SavedFile& file, const SavedRows& saved, WorldState& world) {
    Model& model = world.model;
    check_clock(file, world.clock, world.scratch.parameters.kick_time);
    check_model(file, model);
    put_records(saved, file, model);
    check_masses(file, model);
    // For a material law without a corotational frame, a step writes neither rotation nor rotation_next, but swaps
    // these two columns. Their values must therefore be equal.
    model.elements.rotation_next = model.elements.rotation;
    model.rebuild_outlines();
    model.derive_all();
    find_holding_attachments(model);
    // note_forces keeps Model::forced true only if it was true before. It must be true if the last force element (load,
    // spring and the like) was removed shortly before the world was saved: the next step counts the work of its last
    // forces.
    model.forced = true;
    note_forces(model);
    model.links_open = true;
    model.note_rest();
    check_cache(file, model, world.cache);
    put_candidates(saved, file, model, world.cache.pairs);
    // this column is not saved; only a search of all pairs would resize it, and the next step may search fewer
    world.cache.search.memory.sphere.resize(model.bodies.slot.size());
    put_limits(saved, file, world.record.limits);
    put_start(saved, file, world.record);
    put_self_crossings(saved, file, world.record);
    world.scratch.contacts = saved.contacts;
    check_contacts(file, model, world.scratch.contacts);
    check_resting_contacts(file, model, world.cache.resting);
}

void expect_hash(const SavedFile& file, WorldState& world) {
    const std::string found = checksum_text(state_hash(world));
    if (found != file.texts().state_hash)
        file.complain("state_hash", file.texts().state_hash, found + ", the hash of the contents of the file");
}

std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) refuse_file(name, "no such file", "check the path");
    if (!std::filesystem::is_regular_file(status)) refuse_file(name, "a folder or device", "check the path");
    std::ifstream in(path, std::ios::binary);
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (!in || error) refuse_file(name, "a file that cannot be opened or read", "check the permissions of the file");
    // The rest is read only if the start is that of a saved world, because other files can have any size.
    std::vector<std::byte> bytes(std::min<std::uint64_t>(size, start_bytes));
    const auto read_on = [&](std::size_t begin) {
        const auto count = static_cast<std::streamsize>(bytes.size() - begin);
        in.read(reinterpret_cast<char*>(bytes.data() + begin), count);
        if (in.gcount() != count)
            refuse_file(name, "bytes that cannot be read", "check the disk, or save the world again");
    };
    read_on(0);
    require_file_start(name, bytes, size);
    const std::size_t begin = bytes.size();
    bytes.resize(size);
    read_on(begin);
    return bytes;
}

}  // namespace

LoadedWorld read_world(const std::string& name, std::span<const std::byte> bytes, const LoadSettings& settings,
                       bool compare_hash) {
    const SavedFile file(name, bytes);
    Reader reader(file);
    SavedRows saved;
    LoadedWorld loaded{world_of(file, settings, reader, saved), {file.texts().note}};
    WorldState& world = WorldAccess::state_of(loaded.world);
    list_state(world, saved, reader);
    reader.require_end();
    derive(file, saved, world);
    if (compare_hash) expect_hash(file, world);
    return loaded;
}

LoadedWorld load_world(const std::filesystem::path& file, const LoadSettings& settings) {
    return read_world(file.string(), read_bytes(file), settings);
}

World World::load(const std::filesystem::path& file, const LoadSettings& settings) {
    return load_world(file, settings).world;
}

World World::from_bytes(std::span<const std::byte> bytes, const LoadSettings& settings) {
    return read_world("saved world", bytes, settings).world;
}

}  // namespace skerry
