// Binds the classes World and handles of the extension module, and checks their use (threads, fork, views).
#include "skerry/world.h"

#include <map>
#include <string>

#include "engine/python/bind.h"
#include "engine/python/world/parts.h"
#include "engine/python/world_object.h"
#include "skerry/cavity.h"
#include "skerry/surface.h"

namespace skerry::python {

WorldObject::WorldObject(World&& from) : world(std::move(from)) {
    const Settings& settings = world.settings();
    if (settings.backend == Backend::threads && settings.threads != 1) Use::note_threads();
}

WorldObject::~WorldObject() {
    if (Use::lost_threads()) [[maybe_unused]]
        auto* left = new World(std::move(world));
}

void Use::raise_busy() {
    nb::object type = nb::module_::import_("skerry._errors").attr("BusyError");
    PyErr_SetString(type.ptr(), "the world is in use by another thread");
    throw nb::python_error();
}

void Use::raise_threads_lost() {
    PyErr_SetString(PyExc_RuntimeError,
                    "this process was made by fork() after a world had started threads, which a fork does not copy; "
                    "start processes by multiprocessing.get_context('spawn')");
    throw nb::python_error();
}

void require_no_views(const WorldObject& object, const char* action) {
    if (object.views.empty()) return;
    std::map<std::string, int> count;
    for (const BodyHandle& body : object.views) ++count[object.world.name(body)];
    std::string list;
    for (const auto& [name, arrays] : count)
        list += (list.empty() ? "" : ", ") + std::to_string(arrays) + " of body '" + name + "'";
    PyErr_Format(PyExc_BufferError,
                 "%s: found arrays of views() in use (%s), expected none, because the call could move their memory; "
                 "delete these arrays and their parts first",
                 action, list.c_str());
    throw nb::python_error();
}

namespace {

template <class HandleType>
void bind_handle(nb::module_& module, const char* name) {
    using Numbers = std::array<std::uint32_t, 3>;
    nb::class_<HandleType>(module, name)
        .def("__eq__", [](const HandleType& a,
                          nb::handle b) { return nb::isinstance<HandleType>(b) && a == nb::cast<HandleType>(b); })
        .def("__hash__",
             [](const HandleType& a) {
                 return (static_cast<std::uint64_t>(a.world) << 40) ^ (static_cast<std::uint64_t>(a.generation) << 20) ^
                        a.slot;
             })
        .def("__getstate__",
             [](const HandleType& a) {
                 return Numbers{a.slot, a.generation, a.world};
             })
        .def("__setstate__", [](HandleType& a, const Numbers& numbers) {
            new (&a) HandleType{.slot = numbers[0], .generation = numbers[1], .world = numbers[2]};
        });
}

}  // namespace

void bind_world(nb::module_& module) {
    bind_handle<MaterialHandle>(module, "MaterialHandle");
    bind_handle<BodyHandle>(module, "BodyHandle");
    bind_handle<ColliderHandle>(module, "ColliderHandle");
    bind_handle<AttachmentHandle>(module, "AttachmentHandle");
    bind_handle<JointHandle>(module, "JointHandle");
    bind_handle<CableHandle>(module, "CableHandle");
    bind_handle<SurfaceSetHandle>(module, "SurfaceSetHandle");
    bind_handle<TieHandle>(module, "TieHandle");
    bind_handle<CavityHandle>(module, "CavityHandle");
    bind_handle<PipeHandle>(module, "PipeHandle");
    bind_handle<FibreHandle>(module, "FibreHandle");
    bind_handle<LoadHandle>(module, "LoadHandle");
    bind_handle<SpringHandle>(module, "SpringHandle");
    bind_anchors(module);
    module.def("end_calls", &CallScope::end_calls);
    module.def("hide_leaks", [] { nb::set_leak_warnings(false); });
    module.def("note_fork", [] {
        Use::note_fork();
        CallScope::note_fork();
    });

    WorldClass type(module, "World");
    bind_building(type);
    bind_advance(type);
    bind_state(type);
    bind_control(type);
    bind_joints(type);
    bind_cables(type);
    bind_surface(type);
    bind_ties(type);
    bind_cavities(type);
    bind_fibres(type);
    bind_loads(type);
    bind_sets(type);
    bind_springs(type);
    bind_views(type);
    bind_visuals(type);
    bind_results(type);
}

}  // namespace skerry::python
