#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/world/save/checks.h"
#include "engine/world/save/list_state.h"
#include "engine/world/save/saved_file.h"
#include "engine/world/save/world_file.h"
#include "engine/world/state_hash.h"

namespace skerry {

namespace {

/// The archive (see list_state.h) that collects the arrays of a world. Each member of a struct becomes an array.
class ArrayLister final : public Archive {
public:
    void column(const std::string& path, AnyColumn column) override {
        add(path, column.type(), column.read(), column.type().bytes, column.size());
    }
    std::vector<ArraySource> take() { return std::move(arrays_); }

private:
    void put_value(const std::string& path, void* value, const RowType& type) override {
        add(path, type, static_cast<const std::byte*>(value), type.bytes, 1);
    }
    void add(const std::string& path, const RowType& type, const std::byte* first, std::size_t stride,
             std::size_t rows) {
        if (type.members == nullptr) {
            if (const auto wrong = find_wrong_real(path, type, first, stride, rows)) refuse(path, *wrong);
            arrays_.push_back({path, type.number, rows, type.width, first, stride});
            return;
        }
        for (const Member& member : type.members())
            add(path + "/" + member.name, *member.type, rows == 0 ? nullptr : first + member.offset, stride, rows);
    }

    /// Throws SceneError, because a file with this number could not be loaded.
    [[noreturn]] static void refuse(const std::string& path, const WrongReal& wrong) {
        skerry::refuse("save", path, at_row(wrong.found, wrong.row), "finite numbers",
                       "a position, a velocity or a load of the world is too large");
    }

    std::vector<ArraySource> arrays_;
};

std::vector<std::byte> bytes_of_world(WorldState& world, const SavedNote& note) {
    world.settle();
    SavedRows saved = rows_to_save(world);
    ArrayLister lister;
    list_settings(world.model.settings, world.model.tuning, saved, lister);
    list_state(world, saved, lister);
    return saved_bytes(lister.take(), {.state_hash = checksum_text(state_hash(world)), .note = note.text});
}

}  // namespace

void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file) {
    world.require_between_steps("save");
    const std::vector<std::byte> bytes = bytes_of_world(world, note);
    write_file(file, [&](std::ostream& out) {
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    });
}

void World::save(const std::filesystem::path& file) const {
    save_world(*state_, {}, file);
}

std::vector<std::byte> World::to_bytes() const {
    state_->require_between_steps("to_bytes");
    return bytes_of_world(*state_, {});
}

}  // namespace skerry
