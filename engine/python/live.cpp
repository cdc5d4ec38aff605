// The live view of a world in a browser.
#include "skerry/live.h"

#include <string>
#include <utility>
#include <vector>

#include "engine/python/bind.h"
#include "engine/python/world_object.h"

namespace skerry::python {

void bind_live(nb::module_& module) {
    nb::class_<LiveView>(module, "LiveView")
        .def(
            "__init__",
            [](LiveView* self, WorldObject& object, const std::string& title, Real rate, int port, bool paused,
               std::vector<RecordedProbe> probes, std::vector<Slider> sliders) {
                Use use(object);
                Use::note_threads();
                new (self) LiveView(object.world, {.title = title,
                                                   .port = port,
                                                   .rate = rate,
                                                   .paused = paused,
                                                   .sliders = std::move(sliders),
                                                   .probes = std::move(probes)});
            },
            nb::arg(), nb::kw_only(), nb::arg("title"), nb::arg("rate"), nb::arg("port"), nb::arg("paused"),
            nb::arg("probes"), nb::arg("sliders"))
        .def("address", &LiveView::address)
        .def("is_open", &LiveView::is_open)
        .def("playing", &LiveView::playing)
        .def("clients", &LiveView::clients)
        .def("frames_sent", &LiveView::frames_sent)
        .def("frames_dropped", &LiveView::frames_dropped)
        .def("resets", &LiveView::resets)
        .def("fail", &LiveView::fail)
        .def("refuse_resets", &LiveView::refuse_resets)
        .def("close", [](LiveView& view) { without_gil([&] { view.close(); }); })
        .def("sync",
             [](LiveView& view, WorldObject& object) {
                 Use use(object);
                 require_no_views(object, "sync");
                 without_gil([&] { view.sync(object.world); });
             })
        .def("between_steps",
             [](LiveView& view, WorldObject& object) {
                 Use use(object);
                 return without_gil([&] { return view.between_steps(object.world); });
             })
        .def("due", [](LiveView& view, WorldObject& object) {
            Use use(object);
            require_no_views(object, "run");
            return without_gil([&] { return view.due(object.world); });
        });
}

}  // namespace skerry::python
