#include "engine/output/collect_frame.h"
#include "engine/output/vtk/vtk_series.h"
#include "skerry/output.h"

#include <utility>

namespace skerry {

struct VtkWriter::Impl {
    VtkSeries series;
};

VtkWriter::VtkWriter(const std::filesystem::path& folder, const std::string& name)
    : impl_(new Impl{.series = VtkSeries(folder, name)}) {}

VtkWriter::~VtkWriter() = default;

void VtkWriter::go_on(const World& world, std::size_t frames, Real frame_step) {
    // The series needs the present bodies and the present poses of the colliders.
    impl_->series.go_on(collect_frame(world), frames, frame_step);
}

void VtkWriter::name_materials(std::vector<std::string> names) {
    impl_->series.name_materials(std::move(names));
}

void VtkWriter::write_frame(const World& world) {
    impl_->series.write_frame(collect_frame(world));
}

void VtkWriter::close() {
    impl_->series.write_index();
}

}  // namespace skerry
