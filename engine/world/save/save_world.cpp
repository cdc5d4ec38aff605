#include <cstring>
#include <ostream>
#include <vector>

#include "engine/hdf5/hdf5_image.h"
#include "engine/output/write_file.h"
#include "engine/world/save/file_head.h"
#include "engine/world/save/list_state.h"
#include "engine/world/save/world_file.h"
#include "engine/world/state_hash.h"

namespace skerry {

namespace {

/// The archive (see list_state.h) that writes to a file.
class StateWriter final : public Archive {
public:
    explicit StateWriter(Hdf5Image& image) : image_(image) {}

    void column(const std::string& path, AnyColumn column) override {
        put_rows(path, column.type(), column.read(), column.size());
    }

private:
    void put_value(const std::string& path, void* value, const RowType& type) override {
        put_rows(path, type, static_cast<const std::byte*>(value), 1);
    }
    void put_rows(const std::string& path, const RowType& type, const std::byte* rows, std::size_t count) {
        if (type.members == nullptr) {
            image_.put_rows(path, hdf5_type(type.number), count, type.width, rows);
            return;
        }
        for (const Member& member : type.members()) {
            const std::size_t bytes = member.type->bytes;
            std::vector<std::byte> values(count * bytes);
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(values.data() + i * bytes, rows + i * type.bytes + member.offset, bytes);
            put_rows(path + "/" + member.name, *member.type, values.data(), count);
        }
    }

    Hdf5Image& image_;
};

}  // namespace

void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file) {
    world.require_between_steps("save");
    world.settle();
    Hdf5Image image(file.string());
    SavedRows saved = rows_to_save(world);
    StateWriter writer(image);
    list_settings(world.model.settings, world.model.tuning, saved, writer);
    list_state(world, saved, writer);
    std::uint64_t hash = state_hash(world);
    writer.value("/state_hash", hash);
    image.put_text("/note", note.text);
    const std::vector<char> body = image.bytes();
    write_file(file, [&](std::ostream& out) {
        out << head_of(body);
        out.write(body.data(), static_cast<std::streamsize>(body.size()));
    });
}

void World::save(const std::filesystem::path& file) const {
    save_world(*state_, {}, file);
}

}  // namespace skerry
