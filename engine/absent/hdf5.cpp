// Replacement for the functions that read and write HDF5 files (contact problems and recorded series), if
// SKERRY_HDF5=OFF. All of them throw SceneError.
#include "engine/absent/refuse_absent.h"
#include "skerry/problem.h"
#include "skerry/recorder.h"

namespace skerry {

ContactProblem read_problem(const std::filesystem::path&) {
    refuse_absent("read_problem", "SKERRY_HDF5");
}
void write_problem(const ContactProblem&, const std::filesystem::path&, std::span<const Vec3>) {
    refuse_absent("write_problem", "SKERRY_HDF5");
}
void Recorder::write_hdf5(const std::filesystem::path&) const {
    refuse_absent("Recorder::write_hdf5", "SKERRY_HDF5");
}

}  // namespace skerry
