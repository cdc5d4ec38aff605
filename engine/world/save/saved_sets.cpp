#include "engine/world/save/saved_sets.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/mesh/sets.h"

namespace skerry {

void expect_rows(const SavedFile& file, const std::string& path, std::size_t found, std::size_t expected,
                 const char* object_kind) {
    if (found != expected)
        file.complain(path, std::to_string(found) + " rows",
                      std::to_string(expected) + ", the number of " + object_kind);
}

SavedSets sets_to_save(const Model& model) {
    SavedSets saved;
    for (std::size_t b = 0; b < model.body_records.size(); ++b) {
        const BodyRecord& record = model.body_records[b];
        const std::vector<Index> label(record.label.begin(), record.label.end());
        append(std::span(label), saved.label);
        for (const auto& [name, set] : record.sets) {
            saved.body.push_back(static_cast<Index>(b));
            append_text(name, saved.name);
            append(std::span(set.nodes), saved.nodes);
            append(std::span(set.tetrahedra), saved.tetrahedra);
            append(std::span(set.faces), saved.faces);
        }
    }
    return saved;
}

void put_sets(const SavedSets& saved, const SavedFile& file, Model& model) {
    const std::size_t bodies = model.body_records.size(), sets = saved.body.size();
    expect_ragged(file, "records/label", saved.label, bodies, "bodies");
    expect_rows_of(file, "sets/body", saved.body, bodies);
    expect_ragged(file, "sets/name", saved.name, sets, "sets");
    expect_ragged(file, "sets/nodes", saved.nodes, sets, "sets");
    expect_ragged(file, "sets/tetrahedra", saved.tetrahedra, sets, "sets");
    expect_ragged(file, "sets/faces", saved.faces, sets, "sets");
    for (std::size_t b = 0; b < bodies; ++b) {
        BodyRecord& record = model.body_records[b];
        const std::span<const Index> label = saved.label[b];
        if (!label.empty() && label.size() != record.tetrahedra.size())
            file.complain("records/label", std::to_string(label.size()) + " labels for body " + std::to_string(b),
                          "none, or one for each of " + std::to_string(record.tetrahedra.size()) + " tetrahedra");
        record.label.assign(label.begin(), label.end());
    }
    for (std::size_t s = 0; s < sets; ++s) {
        const Index body = saved.body[s];
        BodyRecord& record = model.body_records[static_cast<std::size_t>(body)];
        const std::string name = text_of_row(saved.name[s]);
        MeshSet set{.nodes = {saved.nodes[s].begin(), saved.nodes[s].end()},
                    .faces = {saved.faces[s].begin(), saved.faces[s].end()},
                    .tetrahedra = {saved.tetrahedra[s].begin(), saved.tetrahedra[s].end()}};
        const Index nodes = model.bodies.nodes[static_cast<std::size_t>(body)].size();
        try {
            mesh::require_set("body " + std::to_string(body), name, set, static_cast<std::size_t>(nodes),
                              record.tetrahedra, record.surface);
        } catch (const SceneError& error) {
            file.complain("sets", std::string("an invalid set (") + error.what() + ")", "numbers of the body");
        }
        mesh::tidy(set);
        record.sets.insert_or_assign(name, std::move(set));
    }
}

}  // namespace skerry
