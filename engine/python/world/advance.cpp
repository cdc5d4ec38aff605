// Advancing a world in time, with callbacks and Ctrl-C.
#include <chrono>
#include <sstream>

#include "engine/python/world/parts.h"
#include "skerry/relax.h"

namespace skerry::python {

namespace {

/// Decides when the next signal must be handled. Throws the exception that a handler raised, such as
/// KeyboardInterrupt.
class SignalWatch {
public:
    void check() {
        CallScope::raise_at_exit();
        const Clock::time_point now = Clock::now();
        if (now - checked_ < std::chrono::milliseconds(20)) return;
        checked_ = now;
        nb::gil_scoped_acquire held;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point checked_ = Clock::now();
};

/// Has World::watch_steps call a Python function until the end of the scope.
class StepWatchScope {
public:
    StepWatchScope(World& world, const nb::object& watch) : world_(world), on_(!watch.is_none()) {
        if (!on_) return;
        world.watch_steps([&watch](const StepReport& report) {
            nb::gil_scoped_acquire held;
            watch(values_of(report));
        });
    }
    ~StepWatchScope() {
        if (on_) world_.watch_steps({});
    }
    StepWatchScope(const StepWatchScope&) = delete;
    StepWatchScope& operator=(const StepWatchScope&) = delete;

private:
    World& world_;
    bool on_;
};

/// Advances without the GIL. `check` is None or is called before each attempt at a step, and ends the call if it
/// returns False. `watch` is None or is called after each committed step.
nb::dict advance(WorldObject& object, Real dt, const nb::object& check, const nb::object& watch) {
    Use use(object);
    World& world = object.world;
    const Settings& settings = world.settings();
    if (settings.backend != Backend::serial && settings.threads != 1) Use::note_threads();
    const nb::object look = object.depth > 1 ? nb::none() : watch;  // advance() refuses a nested call
    const StepWatchScope scope(world, look);
    const StepReport report = without_gil([&] {
        SignalWatch signals;
        return world.advance(dt, [&](const StepReport& so_far) {
            signals.check();
            if (check.is_none()) return true;
            nb::gil_scoped_acquire held;
            return nb::cast<bool>(check(values_of(so_far)));
        });
    });
    return values_of(report);
}

/// Relaxes a world without the GIL.
nb::dict relax_world(WorldObject& object, Real tolerance, int max_steps, int load_steps) {
    Use use(object);
    require_no_views(object, "relax");
    const RelaxReport report = without_gil([&] {
        SignalWatch signals;
        return relax(object.world, {.tolerance = tolerance, .max_steps = max_steps, .load_steps = load_steps},
                     [&](const RelaxReport&) {
                         signals.check();
                         return true;
                     });
    });
    nb::dict values;
    values["converged"] = report.converged;
    values["load"] = report.load;
    values["residual"] = report.residual;
    values["worst"] = report.worst ? object_of(*report.worst) : nb::none();
    values["speed"] = report.speed;
    values["steps"] = report.steps;
    values["seconds"] = report.seconds;
    values["message"] = report.message;
    return values;
}

}  // namespace

void bind_advance(WorldClass& type) {
    type.def("advance", &advance, nb::arg("dt"), nb::arg("check").none(), nb::arg("watch").none())
        .def("relax", &relax_world)
        // World::watch_steps refuses calls of callbacks. It has no other effect, because StepWatchScope has removed its
        // function.
        .def("require_between_steps", guarded([](World& world) { world.watch_steps({}); }))
        .def("set_tracing", guarded([](World& world, bool on) { world.set_tracing(on); }))
        .def("trace_text", guarded([](World& world) {
                 std::ostringstream text;
                 world.write_trace(text);
                 return text.str();
             }))
        .def("step_graph", guarded([](World& world) { return world.step_graph(); }));
}

}  // namespace skerry::python
