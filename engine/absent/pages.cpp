// Replacement for engine/output/page if SKERRY_PAGES=OFF. Creating a PageWriter then throws SceneError.
#include "engine/absent/refuse_absent.h"
#include "skerry/output.h"

namespace skerry {

struct PageWriter::Impl {};

PageWriter::PageWriter(const std::filesystem::path&, const std::string&) {
    refuse_absent("PageWriter", "SKERRY_PAGES");
}
PageWriter::~PageWriter() = default;
void PageWriter::add_frame(const World&) {}
void PageWriter::close(const World&) {}

}  // namespace skerry
