// Replacement for engine/hdf5, engine/world/save, and the files of contact problems and series, if SKERRY_HDF5=OFF. All
// functions throw SceneError.
#include "engine/absent/refuse_absent.h"
#include "skerry/problem.h"
#include "skerry/recorder.h"
#include "skerry/world.h"

namespace skerry {

void World::save(const std::filesystem::path&) const {
    refuse_absent("World::save", "SKERRY_HDF5");
}
World World::load(const std::filesystem::path&, const LoadSettings&) {
    refuse_absent("World::load", "SKERRY_HDF5");
}
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
