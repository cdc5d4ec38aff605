#include "engine/scene/case_hash.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>

#include "components/hash.h"
#include "engine/output/number_text.h"
#include "engine/scene/assign.h"
#include "engine/scene/parse_json.h"

namespace skerry {

namespace {

void add_text(const std::string& text, Hash& hash) {
    hash.add(text.size());
    hash.add(text.data(), text.size());
}

}  // namespace

CaseHasher::CaseHasher(const std::filesystem::path& scene) : file_(scene), scene_(read_json(scene)) {}

std::string CaseHasher::hash(std::span<const std::string> assignments) {
    Json json = scene_;
    Hash all;
    try {
        for (const std::string& assignment : assignments) assign(assignment, file_, json);
    } catch (const SceneError&) {
        for (const std::string& assignment : assignments) add_text(assignment, all);
    }
    add_text(json.dump(-1, ' ', false, Json::error_handler_t::replace), all);
    add_files(json, file_, all);
    return hash_text(all.value());
}

std::vector<std::filesystem::path> CaseHasher::files() const {
    std::vector<std::filesystem::path> files;
    for (const auto& [file, hash] : files_) files.push_back(file);
    return files;
}

std::uint64_t CaseHasher::hash_of_file(const std::filesystem::path& file) {
    const auto known = files_.find(file);
    if (known != files_.end()) return known->second;
    // Preliminary hash, which ends the recursion if the file includes itself.
    files_[file] = 0;
    Hash hash;
    std::ifstream stream(file, std::ios::binary);
    add_text({std::istreambuf_iterator<char>(stream), {}}, hash);
    // The .node and the .ele file of a TetGen mesh belong together and share their name. A scene names only one of
    // them, so the hash covers both.
    for (const auto& [one, other] : {std::pair{".node", ".ele"}, std::pair{".ele", ".node"}})
        if (file.extension() == one) {
            std::ifstream beside(std::filesystem::path(file).replace_extension(other), std::ios::binary);
            add_text({std::istreambuf_iterator<char>(beside), {}}, hash);
        }
    if (file.extension() == ".json") {
        try {
            add_files(read_json(file), file, hash);
        } catch (const SceneError&) {  // ignored here, because the run of the case reports this error
        }
    }
    return files_[file] = hash.value();
}

void CaseHasher::add_files(const Json& json, const std::filesystem::path& source_file, Hash& hash) {
    const auto add = [&](const Json& name) {
        if (name.is_string()) hash.add(hash_of_file(source_file.parent_path() / name.get_ref<const std::string&>()));
    };
    if (!json.is_structured()) return;
    constexpr std::string_view keys[] = {"include", "scene", "file", "surface", "visual"};
    for (const auto& [key, value] : json.items()) {
        if (json.is_object() && std::ranges::find(keys, key) != std::end(keys)) {
            add(value);
            if (value.is_array())
                for (const Json& item : value) add(item);
        }
        add_files(value, source_file, hash);
    }
}

}  // namespace skerry
