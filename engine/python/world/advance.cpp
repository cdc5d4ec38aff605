// Advancing a world in time, with callbacks and Ctrl-C.
#include <chrono>
#include <optional>
#include <sstream>

#include "engine/python/world/parts.h"
#include "skerry/relax.h"

namespace skerry::python {

namespace {

/// check() handles pending signals such as Ctrl-C, at most every 20 ms, and throws the exception that a signal handler
/// raised, such as KeyboardInterrupt. Once Python ends, it throws SystemExit.
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

/// Makes a world call Python functions with the report and the contact problem of steps, during the lifetime of this
/// object. Functions stored for longer could form a reference cycle with the world, which Python's garbage collector
/// would not find.
class WatchScope {
public:
    WatchScope(World& world, const nb::object& watch, const nb::object& take, std::uint64_t every) : world_(world) {
        if (!watch.is_none())
            world.watch_steps([&watch](const StepReport& report) {
                nb::gil_scoped_acquire held;
                watch(values_of(report));
            });
        if (!take.is_none())
            world.watch_contact_problems(
                [&take](const StepProblem& step) {
                    nb::gil_scoped_acquire held;
                    take(values_of(step));
                },
                every);
    }
    ~WatchScope() {
        world_.watch_steps({});
        world_.watch_contact_problems({});
    }
    WatchScope(const WatchScope&) = delete;
    WatchScope& operator=(const WatchScope&) = delete;

private:
    World& world_;
};

/// Advances without the GIL. The functions are optional (None):
/// - `check` is called before each attempt at a step; the call of advance() ends if it returns False.
/// - `watch` is called after each committed step.
/// - `take` is called with the contact problem of each step whose number is a multiple of `every`.
nb::dict advance(WorldObject& object, Real dt, const nb::object& check, const nb::object& watch, const nb::object& take,
                 std::uint64_t every) {
    Use use(object);
    World& world = object.world;
    const Settings& settings = world.settings();
    if (settings.backend != Backend::serial && settings.threads != 1) Use::note_threads();
    std::optional<WatchScope> scope;
    if (object.depth == 1) scope.emplace(world, watch, take, every);  // advance() refuses a nested call (depth > 1)
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
    type.def("advance", &advance, nb::arg("dt"), nb::arg("check").none(), nb::arg("watch").none(),
             nb::arg("take").none(), nb::arg("every"))
        .def("relax", &relax_world)
        // World::watch_steps() is called here because it throws during advance(). It also removes the registered
        // function, but outside of advance() none is registered (see WatchScope).
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
