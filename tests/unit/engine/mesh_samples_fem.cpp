// Sample files of finite-element programs.
#include <bit>
#include <cstdint>
#include <map>

#include "mesh_sample_text.h"
#include "mesh_samples.h"

namespace skerry::test {

namespace {

/// Writes the sections of a Medit file.
class MeditFile {
public:
    MeditFile(int version, Bytes bytes)
        : binary_(bytes != Bytes::text), swap_(bytes == Bytes::foreign), version_(version) {
        if (!binary_) {
            file = "MeshVersionFormatted 2\n# a comment\nDimension\n3\n";
            return;
        }
        put<std::int32_t>(file, 1, swap_);
        put<std::int32_t>(file, version, swap_);
        section("Dimension", 3, [&] { put<std::int32_t>(file, 3, swap_); });
    }

    void section(const char* keyword, int code, auto&& rows) {
        if (!binary_) {
            file += std::string(keyword) + '\n';
            rows();
            return;
        }
        put<std::int32_t>(file, code, swap_);
        const std::size_t place = file.size();
        place_of_next(0);
        rows();
        const std::string behind = file.substr(place + (version_ >= 3 ? 8 : 4));
        const std::size_t next = file.size();
        file.resize(place);
        place_of_next(next);
        file += behind;
    }
    void integer(std::int64_t value) {
        if (!binary_)
            file += std::to_string(value) + ' ';
        else if (version_ == 4)
            put<std::int64_t>(file, value, swap_);
        else
            put<std::int32_t>(file, static_cast<std::int32_t>(value), swap_);
    }
    void position(const Vec3& x) {
        if (!binary_) file += text(x) + ' ';
        for (std::size_t a = 0; binary_ && a < 3; ++a) {
            const Real value = x[static_cast<Eigen::Index>(a)];
            version_ == 1 ? put(file, static_cast<float>(value), swap_) : put(file, value, swap_);
        }
    }
    void end_line() { file += binary_ ? "" : "\n"; }

    std::string file{};

private:
    void place_of_next(std::size_t place) {
        version_ >= 3 ? put<std::int64_t>(file, static_cast<std::int64_t>(place), swap_)
                      : put<std::int32_t>(file, static_cast<std::int32_t>(place), swap_);
    }

    bool binary_, swap_;
    int version_;
};

}  // namespace

std::string medit_file(const Mesh& mesh, int version, Bytes bytes) {
    MeditFile medit(version, bytes);
    const auto row = [&](std::initializer_list<std::int64_t> numbers) {
        for (const std::int64_t number : numbers) medit.integer(number);
        medit.end_line();
    };
    medit.section("Vertices", 4, [&] {
        row({static_cast<std::int64_t>(mesh.nodes.size() + 1)});
        for (const Vec3& x : mesh.nodes) medit.position(x), row({0});
        medit.position({9, 9, 9}), row({5});
    });
    medit.section("RequiredVertices", 15, [&] { row({2}), row({1}), row({2}); });
    medit.section("Triangles", 6, [&] { row({1}), row({1, 2, 3, 8}); });
    medit.section("Edges", 5, [&] { row({1}), row({1, 2, 4}); });
    medit.section("Tetrahedra", 8, [&] {
        row({static_cast<std::int64_t>(mesh.tetrahedra.size())});
        for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
            const auto& [a, b, c, d] = mesh.tetrahedra[e];
            row({a + 1, b + 1, c + 1, d + 1, label_of(mesh, e)});
        }
    });
    medit.section("End", 54, [] {});
    return medit.file;
}

std::string abaqus_file(const Mesh& mesh) {
    std::string file = "*Heading\n a mesh\n** a comment\n*Node\n";
    const auto fields = [](std::string row) {
        std::ranges::replace(row, ' ', ',');
        return row;
    };
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        file += std::to_string(n + 1) + ',' + fields(text(mesh.nodes[n])) + '\n';
    file += "999, 9., 9., 9.\n*ELEMENT, type=S3\n9999, 1, 2, 3\n";
    std::map<int, std::string> sets;  // by label
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        file += "*Element, Type=C3D4\n" + std::to_string(e + 1) + ",\n" +
                fields(text(mesh.tetrahedra[e], 1)).substr(1) + '\n';
        sets[label_of(mesh, e)] += std::to_string(e + 1) + ",\n";
    }
    for (const auto& [label, elements] : sets) {
        const std::string name = "M" + std::to_string(label);
        file += "*Elset, elset=" + name + '\n' + elements;
        if (!mesh.label.empty()) file += "*Solid Section, elset=" + name + ",\n material=" + name + "\n1.,\n";
    }
    return file + "*Step\n*Static\n0.1, 1.\n*End Step\n";
}

}  // namespace skerry::test
