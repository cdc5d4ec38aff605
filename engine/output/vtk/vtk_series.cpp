#include "engine/output/vtk/vtk_series.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <ostream>
#include <sstream>
#include <utility>

#include "components/check.h"
#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/escape_markup.h"
#include "engine/output/shape_picture.h"
#include "engine/output/vtk/vtk_arrays.h"
#include "engine/output/vtk/vtk_file.h"
#include "engine/output/vtk/write_visuals.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {
namespace {

constexpr std::uint8_t vtk_triangle = 5, vtk_tetra = 10;
constexpr std::size_t least_digits = 4;  // frame numbers are padded with zeros to this number of digits
constexpr std::pair<const char*, const char*> kinds[] = {
    {"bodies", ".vtu"}, {"contacts", ".vtp"}, {"colliders", ".vtp"}, {"lines", ".vtp"}, {"visual", ".vtp"}};

template <class Handle>
Index number_of(const std::map<Handle, Index>& numbers, Handle handle) {
    const auto found = numbers.find(handle);
    return found == numbers.end() ? -1 : found->second;
}

}  // namespace

bool is_series_file(std::string_view file_name, std::string_view name) {
    if (!file_name.starts_with(name)) return false;
    file_name.remove_prefix(name.size());
    if (file_name == ".pvd") return true;
    for (const auto& [what, extension] : kinds) {
        const std::string before = "_" + std::string(what) + "_";
        if (!file_name.starts_with(before) || !file_name.ends_with(extension)) continue;
        const std::size_t around = before.size() + std::string_view(extension).size();
        if (file_name.size() < around + least_digits) return false;
        const std::string_view digits = file_name.substr(before.size(), file_name.size() - around);
        return std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
    }
    return false;
}

VtkSeries::VtkSeries(std::filesystem::path folder, std::string name)
    : folder_(std::move(folder)), name_(std::move(name)) {
    if (name_.empty() || name_.find_first_of("/\\") != std::string::npos)
        refuse_in(folder_.string(), "output", "name", "\"" + name_ + "\"", "a file name without / and \\");
    make_folder(folder_);
    // The name of the index sorts first, so the index is removed first. If the removal of another file then fails, no
    // index is left that names missing files.
    earlier_ = EarlierFiles(folder_, [&](const std::string& file) { return is_series_file(file, name_); });
}

std::string VtkSeries::frame_file(const char* part, const char* extension) const {
    std::string digits = std::to_string(frame_count_);
    if (digits.size() < least_digits) digits.insert(0, least_digits - digits.size(), '0');
    return name_ + "_" + part + "_" + digits + extension;
}

void VtkSeries::number(const Frame& frame) {
    for (const BodyFrame& body : frame.bodies) {
        if (body_number_.try_emplace(body.handle, static_cast<Index>(body_number_.size())).second)
            body_names_.push_back(body.name);
        origin_.try_emplace(body.handle, body.position.begin(), body.position.end());
        for (const Index material : body.material)
            while (material >= static_cast<Index>(material_names_.size()))
                material_names_.push_back("material " + std::to_string(material_names_.size()));
    }
    for (const ColliderFrame& collider : frame.colliders)
        if (collider_number_.try_emplace(collider.handle, static_cast<Index>(collider_number_.size())).second)
            collider_names_.push_back(collider.name);
    for (const LineFrame& line : frame.lines)
        if (line_number_.try_emplace(line.key(), static_cast<Index>(line_number_.size())).second)
            line_names_.push_back(line.name);
}

/// Reads the node positions of the first frame, from which displacements are measured. Does nothing if the file of this
/// frame is missing or has a different number of nodes than `now`.
void VtkSeries::read_origins(const Frame& now) {
    std::size_t points = 0;
    for (const BodyFrame& body : now.bodies) points += body.position.size();
    std::ifstream in(folder_ / frame_file("bodies", ".vtu"), std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    const std::string file = text.str(), start = "<AppendedData encoding=\"raw\">_";
    const std::size_t found = file.find(start), first = found + start.size() + sizeof(std::uint64_t);
    std::uint64_t bytes = 0;  // size of the first array of the file, which contains the positions [bytes]
    if (found == std::string::npos || first + points * sizeof(Vec3) > file.size()) return;
    std::memcpy(&bytes, file.data() + found + start.size(), sizeof bytes);
    if (bytes != points * sizeof(Vec3)) return;
    const char* number_text = file.data() + first;
    for (const BodyFrame& body : now.bodies) {
        std::vector<Vec3>& origin = origin_[body.handle];
        origin.resize(body.position.size());
        std::memcpy(static_cast<void*>(origin.data()), number_text, origin.size() * sizeof(Vec3));
        number_text += origin.size() * sizeof(Vec3);
    }
}

void VtkSeries::go_on(const Frame& now, std::size_t frames, Real frame_step) {
    read_origins(now);
    number(now);
    const auto list = [&](int part, const std::string& file) {
        std::error_code ignored;
        const bool there = std::filesystem::exists(folder_ / file, ignored);
        earlier_.keep(folder_ / file);  // files of the run that is continued must not be removed
        if (there) entries_.push_back({static_cast<Real>(frame_count_) * frame_step, part, file});
        return there;
    };
    for (; frame_count_ < frames; ++frame_count_) {
        const std::string colliders = frame_file("colliders", ".vtp");
        list(0, frame_file("bodies", ".vtu"));
        list(1, frame_file("contacts", ".vtp"));
        if (list(2, colliders))
            colliders_file_ = colliders;
        else if (!colliders_file_.empty())
            list(2, colliders_file_);
        list(3, frame_file("lines", ".vtp"));
        list(4, frame_file("visual", ".vtp"));
    }
    // colliders_changed() is called for its side effect: it stores the poses of the colliders in this frame. Later
    // frames then refer to the last file of colliders until a collider moves.
    if (!colliders_file_.empty()) colliders_changed(now);
}

void VtkSeries::write_frame(const Frame& frame) {
    earlier_.remove();
    try {
        write_files(frame);
    } catch (...) {
        for (const auto& [what, extension] : kinds) {
            const std::filesystem::path file = folder_ / frame_file(what, extension);
            std::error_code ignored;
            if (std::filesystem::symlink_status(file, ignored).type() == std::filesystem::file_type::regular)
                std::filesystem::remove(file, ignored);
        }
        colliders_prev_.clear();
        throw;
    }
}

void VtkSeries::write_files(const Frame& frame) {
    number(frame);
    const std::string bodies = frame_file("bodies", ".vtu"), contacts = frame_file("contacts", ".vtp");
    write_bodies(frame, bodies);
    write_contacts(frame, contacts);
    if (colliders_changed(frame)) {
        if (!patch_) patch_ = patch_around(frame.bodies);
        const std::string colliders = frame_file("colliders", ".vtp");
        write_colliders(frame, colliders);
        colliders_file_ = colliders;
    }
    entries_.push_back({frame.time, 0, bodies});
    entries_.push_back({frame.time, 1, contacts});
    if (!colliders_file_.empty()) entries_.push_back({frame.time, 2, colliders_file_});
    if (!line_number_.empty()) {
        const std::string lines = frame_file("lines", ".vtp");
        write_lines(frame, lines);
        entries_.push_back({frame.time, 3, lines});
    }
    if (std::ranges::any_of(frame.bodies, [](const BodyFrame& body) { return body.visual != nullptr; })) {
        const std::string visual = frame_file("visual", ".vtp");
        write_visuals(frame, {body_number_, body_names_, origin_}, folder_ / visual);
        entries_.push_back({frame.time, 4, visual});
    }
    ++frame_count_;
}

void VtkSeries::write_bodies(const Frame& frame, const std::string& name) const {
    std::size_t points = 0, cells = 0, corners = 0;
    for (const BodyFrame& body : frame.bodies) {
        SKERRY_CHECK(body.velocity.size() == body.position.size() && body.node_stress.size() == body.position.size() &&
                     body.node_mesh_error.size() == body.position.size());
        SKERRY_CHECK(body.stress.size() == body.count_cells() && body.strain.size() == body.count_cells());
        points += body.position.size();
        cells += body.count_cells();
        corners += body.count_cells() * body.corners_of_cell();
    }
    const auto of_nodes = [&](auto per_node) {
        return [&frame, per_node](auto put) {
            for (const BodyFrame& body : frame.bodies)
                for (std::size_t node = 0; node < body.position.size(); ++node) per_node(put, body, node);
        };
    };
    const auto of_cells = [&](auto per_cell) {
        return [&frame, per_cell](auto put) {
            for (const BodyFrame& body : frame.bodies)
                for (std::size_t cell = 0; cell < body.count_cells(); ++cell) per_cell(put, body, cell);
        };
    };

    VtkFile file("UnstructuredGrid", frame.time);  // no VtkTexts, because meshio cannot read them
    file.open("Piece", count_attribute("Points", points) + count_attribute("Cells", cells));
    // Positions are doubles, because users compute small differences of them (gaps, displacements, strains), for which
    // floats have too few digits. All other real numbers are floats; their rounding errors are smaller than the errors
    // of the simulation.
    file.open("Points");
    file.array<double>("Points", 3, points,
                       of_nodes([](auto& put, const BodyFrame& b, std::size_t n) { put_vector(put, b.position[n]); }));
    file.close("Points");
    file.open("Cells");
    file.array<std::int32_t>("connectivity", 1, corners, [&](auto put) {
        Index first = 0;
        for (const BodyFrame& body : frame.bodies) {
            const auto put_cells = [&](const auto& rows) {
                for (const auto& cell : rows)
                    for (const Index node : cell) put(first + node);
            };
            body.tetrahedra.empty() ? put_cells(body.surface) : put_cells(body.tetrahedra);
            first += static_cast<Index>(body.position.size());
        }
    });
    Index end = 0;  // index in `connectivity` after the last corner of the present cell
    file.array<std::int32_t>("offsets", 1, cells, of_cells([&end](auto& put, const BodyFrame& b, std::size_t) {
                                 put(end += static_cast<Index>(b.corners_of_cell()));
                             }));
    file.array<std::uint8_t>("types", 1, cells, of_cells([](auto& put, const BodyFrame& b, std::size_t) {
                                 put(b.tetrahedra.empty() ? vtk_triangle : vtk_tetra);
                             }));
    file.close("Cells");
    file.open("PointData");
    file.array<float>("displacement", 3, points, of_nodes([this](auto& put, const BodyFrame& b, std::size_t n) {
                          put_vector(put, b.position[n] - origin_.at(b.handle)[n]);
                      }));
    file.array<float>("velocity", 3, points,
                      of_nodes([](auto& put, const BodyFrame& b, std::size_t n) { put_vector(put, b.velocity[n]); }));
    file.array<float>("speed", 1, points,
                      of_nodes([](auto& put, const BodyFrame& b, std::size_t n) { put(b.velocity[n].norm()); }));
    file.array<float>("von_mises", 1, points,
                      of_nodes([](auto& put, const BodyFrame& b, std::size_t n) { put(von_mises(b.node_stress[n])); }));
    file.array<float>("mesh_error", 1, points,
                      of_nodes([](auto& put, const BodyFrame& b, std::size_t n) { put(b.node_mesh_error[n]); }));
    file.array<float>("principal_stresses", 3, points, of_nodes([](auto& put, const BodyFrame& b, std::size_t n) {
                          put_vector(put, principal_stresses(b.node_stress[n]));
                      }));
    file.array<float>("stress", 6, points, of_nodes([](auto& put, const BodyFrame& b, std::size_t n) {
                          put_symmetric(put, b.node_stress[n]);
                      }));
    file.array<float>("strain", 6, points, of_nodes([](auto& put, const BodyFrame& b, std::size_t n) {
                          put_symmetric(put, b.node_strain[n]);
                      }));
    file.close("PointData");
    file.open("CellData");
    file.array<float>("von_mises", 1, cells,
                      of_cells([](auto& put, const BodyFrame& b, std::size_t c) { put(von_mises(b.stress[c])); }));
    file.array<float>("stress", 6, cells,
                      of_cells([](auto& put, const BodyFrame& b, std::size_t c) { put_symmetric(put, b.stress[c]); }));
    file.array<float>("strain", 6, cells,
                      of_cells([](auto& put, const BodyFrame& b, std::size_t c) { put_symmetric(put, b.strain[c]); }));
    const auto has_plastic_strain = [](const BodyFrame& b) { return !b.plastic_strain.empty(); };
    if (std::ranges::any_of(frame.bodies, has_plastic_strain))
        file.array<float>("plastic_strain", 1, cells,
                          of_cells([](auto& put, const BodyFrame& b, std::size_t c) { put(b.plastic_strain[c]); }));
    const auto has_fibres = [](const BodyFrame& b) { return !b.fibre_stretch.empty(); };
    if (std::ranges::any_of(frame.bodies, has_fibres)) {
        file.array<float>("fibre_stretch", 1, cells, of_cells([&](auto& put, const BodyFrame& b, std::size_t c) {
                              put(has_fibres(b) ? b.fibre_stretch[c] : 1);
                          }));
        file.array<float>("fibre_stress", 1, cells, of_cells([&](auto& put, const BodyFrame& b, std::size_t c) {
                              put(has_fibres(b) ? b.fibre_stress[c] : 0);
                          }));
    }
    file.array<std::int32_t>("body", 1, cells, of_cells([this](auto& put, const BodyFrame& b, std::size_t) {
                                 put(number_of(body_number_, b.handle));
                             }));
    file.array<std::int32_t>("material", 1, cells, of_cells([](auto& put, const BodyFrame& b, std::size_t c) {
                                 put(b.material.empty() ? no_index : b.material[c]);
                             }));
    file.close("CellData");
    file.close("Piece");
    file.write(folder_ / name);
}

void VtkSeries::write_contacts(const Frame& frame, const std::string& name) const {
    const std::span<const Contact> rows = frame.contacts;
    VtkFile file(
        "PolyData", frame.time,
        {{"body_names", body_names_}, {"material_names", material_names_}, {"collider_names", collider_names_}});
    file.open("Piece", count_attribute("Points", rows.size()) + count_attribute("Verts", rows.size()) +
                           count_attribute("Polys", 0));
    file.open("Points");
    file.array<double>("Points", 3, rows.size(), [&](auto put) {
        for (const Contact& contact : rows) put_vector(put, contact.point);
    });
    file.close("Points");
    file.open("Verts");
    file.array<std::int32_t>("connectivity", 1, rows.size(), [&](auto put) {
        for (std::size_t row = 0; row < rows.size(); ++row) put(row);
    });
    offsets(file, rows.size(), 1);
    file.close("Verts");
    file.open("PointData");
    vectors(file, "impulse", rows, [](const Contact& c) { return c.impulse; });
    vectors(file, "force", rows, [&](const Contact& c) { return c.force(); });
    vectors(file, "normal", rows, [](const Contact& c) { return c.normal; });
    vectors(file, "slip", rows, [](const Contact& c) { return c.slip; });
    scalars<float>(file, "distance", rows, [](const Contact& c) { return c.distance; });
    scalars<float>(file, "gap", rows, [](const Contact& c) { return c.gap; });
    scalars<std::uint8_t>(file, "state", rows, [](const Contact& c) { return c.motion; });
    scalars<std::int32_t>(file, "region", rows, [](const Contact& c) { return c.region; });
    scalars<std::int32_t>(file, "first_body", rows, [&](const Contact& c) { return number_of(body_number_, c.first); });
    scalars<std::int32_t>(file, "second_body", rows,
                          [&](const Contact& c) { return number_of(body_number_, c.second); });
    scalars<std::int32_t>(file, "collider", rows,
                          [&](const Contact& c) { return number_of(collider_number_, c.collider); });
    file.close("PointData");
    file.close("Piece");
    file.write(folder_ / name);
}

bool VtkSeries::colliders_changed(const Frame& frame) {
    const auto is_unchanged = [](const auto& prev, const ColliderFrame& now) {
        return prev.first == now.handle && prev.second.position == now.pose.position &&
               prev.second.rotation == now.pose.rotation;
    };
    if (std::ranges::equal(colliders_prev_, frame.colliders, is_unchanged)) return false;
    colliders_prev_.clear();
    for (const ColliderFrame& collider : frame.colliders) colliders_prev_.emplace_back(collider.handle, collider.pose);
    return true;
}

void VtkSeries::write_colliders(const Frame& frame, const std::string& name) const {
    std::vector<Vec3> nodes;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<Index> numbers;
    for (const ColliderFrame& collider : frame.colliders) {
        PlanePatch patch = patch_.value_or(PlanePatch{});
        patch.center = to_shape(collider.pose, patch.center);
        const SurfaceMesh picture = shape_picture(*collider.shape, patch);
        const Index first = static_cast<Index>(nodes.size());
        for (const Vec3& node : picture.nodes) nodes.push_back(to_world(collider.pose, node));
        for (const auto& [a, b, c] : picture.triangles) triangles.push_back({first + a, first + b, first + c});
        numbers.resize(triangles.size(), number_of(collider_number_, collider.handle));
    }
    VtkFile file("PolyData", frame.time, {{"collider_names", collider_names_}});
    file.open("Piece", count_attribute("Points", nodes.size()) + count_attribute("Polys", triangles.size()));
    file.open("Points");
    file.array<double>("Points", 3, nodes.size(), [&](auto put) {
        for (const Vec3& node : nodes) put_vector(put, node);
    });
    file.close("Points");
    file.open("Polys");
    file.array<std::int32_t>("connectivity", 1, 3 * triangles.size(), [&](auto put) {
        for (const auto& triangle : triangles)
            for (const Index node : triangle) put(node);
    });
    offsets(file, triangles.size(), 3);
    file.close("Polys");
    file.open("CellData");
    scalars<std::int32_t>(file, "collider", numbers, [](Index number) { return number; });
    file.close("CellData");
    file.close("Piece");
    file.write(folder_ / name);
}

void VtkSeries::write_lines(const Frame& frame, const std::string& name) const {
    struct Cell {
        const LineFrame* line;
        Index first, second;  // indices of the end points in `points`; equal for a cell that is a point
        Real force;
    };
    std::vector<Cell> vertices, segments;
    std::vector<Vec3> points;
    for (const LineFrame& line : frame.lines) {
        const bool has_segments = line.is_joined() && line.points.size() > 1;
        for (std::size_t p = 0; p < line.points.size(); ++p) {
            const auto row = static_cast<Index>(points.size());
            points.push_back(line.points[p]);
            if (!has_segments)
                vertices.push_back({&line, row, row, line.force[p]});
            else if (p + 1 < line.points.size())
                segments.push_back({&line, row, row + 1, line.force[p]});
        }
    }
    std::vector<Cell> cells = vertices;  // VTK numbers vertices before lines
    cells.insert(cells.end(), segments.begin(), segments.end());
    VtkFile file("PolyData", frame.time, {{"line_names", line_names_}});
    file.open("Piece", count_attribute("Points", points.size()) + count_attribute("Verts", vertices.size()) +
                           count_attribute("Lines", segments.size()));
    file.open("Points");
    file.array<double>("Points", 3, points.size(), [&](auto put) {
        for (const Vec3& point : points) put_vector(put, point);
    });
    file.close("Points");
    file.open("Verts");
    scalars<std::int32_t>(file, "connectivity", vertices, [](const Cell& cell) { return cell.first; });
    offsets(file, vertices.size(), 1);
    file.close("Verts");
    file.open("Lines");
    file.array<std::int32_t>("connectivity", 1, 2 * segments.size(), [&](auto put) {
        for (const Cell& cell : segments) {
            put(cell.first);
            put(cell.second);
        }
    });
    offsets(file, segments.size(), 2);
    file.close("Lines");
    file.open("CellData");
    scalars<std::uint8_t>(file, "kind", cells, [](const Cell& cell) { return cell.line->kind; });
    scalars<std::int32_t>(file, "line", cells, [&](const Cell& cell) { return line_number_.at(cell.line->key()); });
    scalars<float>(file, "force", cells, [](const Cell& cell) { return cell.force; });
    file.close("CellData");
    file.close("Piece");
    file.write(folder_ / name);
}

void VtkSeries::write_index() const {
    write_file(folder_ / (name_ + ".pvd"), [&](std::ostream& out) {
        out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
               "byte_order=\"LittleEndian\">\n<Collection>\n";
        for (const auto& [time, part, file] : entries_)
            out << "<DataSet timestep=\"" << number_text(time) << "\" group=\"\" part=\"" << part << "\" name=\""
                << kinds[part].first << "\" file=\"" << escape_markup(file) << "\"/>\n";
        out << "</Collection>\n</VTKFile>\n";
    });
}

}  // namespace skerry
