#include "skerry/world.h"

#include <chrono>

#include "engine/python/bind.h"
#include "engine/python/read_settings.h"
#include "engine/python/world_object.h"

namespace skerry::python {

void Use::raise_busy() {
    nb::object type = nb::module_::import_("skerry._errors").attr("BusyError");
    PyErr_SetString(type.ptr(), "the world is in use by another thread");
    throw nb::python_error();
}

void require_no_views(const WorldObject& object, const char* action) {
    if (object.views == 0) return;
    PyErr_Format(PyExc_BufferError, "%s: %d arrays of views() are still in use", action, object.views);
    throw nb::python_error();
}

namespace {

template <class HandleType>
void bind_handle(nb::module_& module, const char* name) {
    nb::class_<HandleType>(module, name)
        .def("__eq__",
             [](const HandleType& a, nb::handle b) {
                 HandleType other;
                 return nb::try_cast(b, other) && a == other;
             })
        .def("__hash__", [](const HandleType& a) {
            return (static_cast<std::uint64_t>(a.world) << 40) ^ (static_cast<std::uint64_t>(a.generation) << 20) ^
                   a.slot;
        });
}

/// Advances without the GIL; Ctrl-C is looked for every 50 ms.
StepReport advance(WorldObject& object, Real dt) {
    Use use(object);
    nb::gil_scoped_release released;
    using Clock = std::chrono::steady_clock;
    Clock::time_point looked = Clock::now();
    bool interrupted = false;
    StepReport report = object.world.advance(dt, [&](const StepReport&) {
        const Clock::time_point now = Clock::now();
        if (now - looked < std::chrono::milliseconds(50)) return true;
        looked = now;
        nb::gil_scoped_acquire held;
        interrupted = PyErr_CheckSignals() != 0;
        return !interrupted;
    });
    if (interrupted) {
        nb::gil_scoped_acquire held;
        throw nb::python_error();
    }
    return report;
}

}  // namespace

void bind_world(nb::module_& module) {
    bind_handle<MaterialHandle>(module, "MaterialHandle");
    bind_handle<BodyHandle>(module, "BodyHandle");
    bind_handle<ColliderHandle>(module, "ColliderHandle");
    bind_handle<AttachmentHandle>(module, "AttachmentHandle");
    bind_handle<JointHandle>(module, "JointHandle");

    nb::class_<StepReport>(module, "StepReport")
        .def_prop_ro("ok", &StepReport::ok)
        .def_prop_ro("message", &StepReport::message)
        .def_ro("steps", &StepReport::steps);

    nb::class_<Mesh>(module, "Mesh")
        .def("__init__", [](Mesh* self, const Vectors& nodes, const IndexRows<4>& tetrahedra) {
            const auto points = span_of(nodes);
            const auto rows = span_of(tetrahedra);
            new (self) Mesh{.nodes{points.begin(), points.end()}, .tetrahedra{rows.begin(), rows.end()}};
        });
    module.def("ball", &mesh::ball);

    nb::class_<WorldObject>(module, "World")
        .def("__init__",
             [](WorldObject* self, nb::handle given) {
                 Settings settings;
                 read(given, settings);
                 new (self) WorldObject(World(settings));
             })
        .def("add_material",
             [](WorldObject& object, nb::handle given) {
                 Use use(object);
                 MaterialSettings settings;
                 read(given, settings);
                 return object.world.add_material(settings);
             })
        .def("add_body",
             [](WorldObject& object, const Mesh& mesh, const MaterialHandle& material, nb::handle given) {
                 Use use(object);
                 require_no_views(object, "add_body");
                 BodySettings settings;
                 read(given, settings);
                 settings.material = material;
                 return object.world.add_body(mesh, settings);
             })
        .def("add_plane", guarded([](World& world, const Vec3& normal, const Vec3& point) {
                 return world.add_collider(Plane{.normal = normal, .point = point});
             }))
        .def("positions", guarded([](World& world, const BodyHandle& body) { return array_of(world.positions(body)); }))
        .def("advance", &advance)
        .def_prop_ro("time", guarded([](World& world) { return world.time(); }))
        .def_prop_ro("contact_count", guarded([](World& world) { return world.contacts().size(); }));
}

}  // namespace skerry::python
