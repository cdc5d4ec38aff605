// Arrays that show the memory of a world without a copy.
#include <algorithm>

#include "engine/python/world/parts.h"

namespace skerry::python {

namespace {

/// Owner of one NumPy array that shows memory of a world. It keeps the world alive. While an owner exists,
/// require_no_views() refuses calls that would move this memory.
class View {
public:
    View(nb::object world, const BodyHandle& body) : world_(std::move(world)), body_(body) {
        object().views.push_back(body);
    }
    ~View() {
        std::vector<BodyHandle>& views = object().views;
        views.erase(std::find(views.begin(), views.end(), body_));
    }
    View(const View&) = delete;
    View& operator=(const View&) = delete;

private:
    WorldObject& object() const { return *nb::inst_ptr<WorldObject>(world_); }

    nb::object world_;
    BodyHandle body_;
};

using ViewArray = nb::ndarray<nb::numpy, const Real, nb::shape<-1, 3>>;

ViewArray view_of(const nb::object& world, const BodyHandle& body, std::span<const Vec3> rows) {
    nb::capsule owner(new View(world, body), [](void* view) noexcept { delete static_cast<View*>(view); });
    return ViewArray(reinterpret_cast<const Real*>(rows.data()), {rows.size(), 3}, owner);
}

nb::tuple views(const nb::object& self, const BodyHandle& body) {
    WorldObject& object = nb::cast<WorldObject&>(self);
    Use use(object);
    const std::span<const Vec3> positions = object.world.positions(body), velocities = object.world.velocities(body);
    return nb::make_tuple(view_of(self, body, positions), view_of(self, body, velocities));
}

}  // namespace

void bind_views(WorldClass& type) {
    type.def("views", &views);
}

}  // namespace skerry::python
