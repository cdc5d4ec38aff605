#include "engine/python/bind.h"
#include "skerry/error.h"

namespace skerry::python {

namespace {

/// Sets the Python exception skerry.SceneError. Python shows the hint as a note of the exception, so the hint is
/// removed from the text and passed separately.
void raise(const SceneError& error) {
    const Complaint& parts = error.complaint();
    std::string text = error.what();
    const std::string hint = " (" + parts.hint + ")";
    if (!parts.hint.empty() && text.ends_with(hint)) text.resize(text.size() - hint.size());
    nb::object type = nb::module_::import_("skerry._errors").attr("SceneError");
    nb::object raised =
        type(text, nb::arg("file") = parts.file, nb::arg("object") = parts.object, nb::arg("field") = parts.field,
             nb::arg("found") = parts.found, nb::arg("expected") = parts.expected, nb::arg("hint") = parts.hint);
    PyErr_SetObject(type.ptr(), raised.ptr());
}

}  // namespace

/// Translates the C++ exception SceneError to the Python exception skerry.SceneError.
void bind_errors(nb::module_&) {
    nb::register_exception_translator([](const std::exception_ptr& raised, void*) {
        try {
            std::rethrow_exception(raised);
        } catch (const SceneError& error) {
            raise(error);
        }
    });
}

void CallScope::raise_at_exit() {
    const unsigned long thread = ending.load();
    if (thread == 0 || thread == PyThread_get_thread_ident()) return;
    nb::gil_scoped_acquire held;
    PyErr_SetNone(PyExc_SystemExit);
    throw nb::python_error();
}

int CallScope::end_calls() {
    ending = PyThread_get_thread_ident();
    return running;
}

}  // namespace skerry::python

NB_MODULE(_core, module) {
    using namespace skerry::python;
    module.doc() = "The C++ interface of Skerry. Import skerry instead.";
    module.attr("version") = SKERRY_VERSION;
    bind_errors(module);
    bind_settings(module);
    bind_materials(module);
    bind_mesh(module);
    bind_problem(module);
    bind_visual_surface(module);
    bind_world(module);
    bind_estimate(module);
    bind_recorder(module);
    bind_rollout(module);
    bind_scene(module);
    bind_study(module);
    bind_live(module);
}
