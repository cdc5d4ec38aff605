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

/// The archive that writes.
class Writer {
public:
    explicit Writer(Hdf5Image& image) : image_(image) {}

    template <class T>
    void column(const std::string& path, const Column<T>& column) {
        rows(path, column.data(), column.size());
    }
    template <class T>
    void value(const std::string& path, const T& value) {
        rows(path, &value, 1);
    }

private:
    template <class T>
    void rows(const std::string& path, const T* first, std::size_t count) {
        if constexpr (HasMembers<T>) {
            std::apply([&](const auto&... member) { (members(path, first, count, member), ...); },
                       MembersOf<T>::list());
        } else {
            using Numbers = NumbersOf<T>;
            static_assert(sizeof(T) == Numbers::count * sizeof(typename Numbers::type), "a row with gaps");
            image_.put_rows(path, hdf5_type<typename Numbers::type>(), count, Numbers::count, first);
        }
    }
    template <class S, class T>
    void members(const std::string& path, const S* first, std::size_t count, const Member<S, T>& member) {
        const auto values = std::make_unique<T[]>(count);
        for (std::size_t i = 0; i < count; ++i) values[i] = first[i].*member.place;
        rows(path + "/" + member.name, values.get(), count);
    }

    Hdf5Image& image_;
};

}  // namespace

void save_world(WorldState& world, const SavedNote& note, const std::filesystem::path& file) {
    world.require_between_steps("save");
    world.settle();
    Hdf5Image image(file.string());
    SavedRows saved = rows_to_save(world);
    Writer writer(image);
    list_settings(world.model.settings, saved, writer);
    list_state(world, saved, writer);
    writer.value("/state_hash", state_hash(world));
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
