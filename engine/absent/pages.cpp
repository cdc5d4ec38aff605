// Replacement for engine/output/page, write_gltf and zlib if SKERRY_PAGES=OFF. Creating a PageWriter, writing glTF, or
// reading a compressed VTK file, then throws SceneError.
#include "engine/absent/refuse_absent.h"
#include "engine/mesh/formats/inflate.h"
#include "engine/output/film/drawn_surface.h"
#include "skerry/output.h"

namespace skerry {

struct PageWriter::Impl {};

PageWriter::PageWriter(const std::filesystem::path&, const std::string&) {
    refuse_absent("PageWriter", "SKERRY_PAGES");
}
PageWriter::~PageWriter() = default;
void PageWriter::add_frame(const World&) {}
void PageWriter::close(const World&) {}

void require_gltf() {
    refuse_absent("write_gltf", "SKERRY_PAGES");
}

void write_gltf(const World&, const std::filesystem::path&, FilmColor, std::optional<Real>) {
    require_gltf();
}

std::optional<std::string> mesh::inflated(std::string_view, std::size_t) {
    refuse_absent("compressed VTK files", "SKERRY_PAGES");
}

}  // namespace skerry
