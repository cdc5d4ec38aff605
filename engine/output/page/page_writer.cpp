#include "engine/base/write_file.h"
#include "engine/output/collect_frame.h"
#include "engine/output/page/page_document.h"
#include "skerry/output.h"

namespace skerry {

struct PageWriter::Impl {
    std::filesystem::path file;
    std::string title;
    PageData data;
};

PageWriter::PageWriter(const std::filesystem::path& file, const std::string& title)
    : impl_(new Impl{.file = file, .title = title, .data = {}}) {
    // A missing three.js and a folder that cannot be created are reported before the run, not after it.
    require_page_library(file);
    if (file.has_parent_path()) make_folder(file.parent_path());
}

PageWriter::~PageWriter() = default;

void PageWriter::add_frame(const World& world) {
    impl_->data.add(collect_frame(world, FrameContent::mesh_error));
}

void PageWriter::close(const World& world) {
    write_page(impl_->file, impl_->data,
               {.title = impl_->title, .report = world.report(), .state_hash = world.state_hash()});
}

}  // namespace skerry
