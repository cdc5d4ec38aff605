#include "engine/python/bind.h"
#include "skerry/error.h"

namespace skerry::python {

/// SceneError becomes skerry.SceneError.
void bind_errors(nb::module_&) {
    nb::register_exception_translator([](const std::exception_ptr& raised, void*) {
        try {
            std::rethrow_exception(raised);
        } catch (const SceneError& error) {
            nb::object type = nb::module_::import_("skerry._errors").attr("SceneError");
            PyErr_SetString(type.ptr(), error.what());
        }
    });
}

}  // namespace skerry::python

NB_MODULE(_core, module) {
    using namespace skerry::python;
    module.doc() = "The C++ interface of Skerry. Import skerry instead.";
    bind_errors(module);
    bind_settings(module);
    bind_mesh(module);
    bind_world(module);
}
