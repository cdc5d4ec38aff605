#include "engine/output/vtk/write_visuals.h"

#include "engine/output/vtk/vtk_arrays.h"
#include "systems/dynamics/elements/element_energy.h"

namespace skerry {

namespace {

/// The visual surfaces of all bodies as one surface, with values by point and by triangle.
struct VisualRows {
    std::vector<Vec3> position, displacement, velocity;
    std::vector<Mat3> stress;
    std::vector<std::array<Real, 2>> texture_point;
    std::vector<std::array<Index, 3>> triangles;
    std::vector<Index> body, material;          // by triangle
    std::vector<std::string> material_names{};  // materials of all surfaces
};

void append_visual(const BodyFrame& body, const SeriesBodies& bodies, VisualRows& rows) {
    const BoundVisual& visual = *body.visual;
    const VisualPoints points = split_at_seams(visual.surface);
    const std::vector<Vec3> position = visual_positions(visual, body.position),
                            origin = visual_positions(visual, bodies.origin.at(body.handle)),
                            velocity = visual_positions(visual, body.velocity);
    const std::vector<Mat3> stress = visual_values<Mat3>(visual, body.node_stress);
    const auto first = static_cast<Index>(rows.position.size());
    for (std::size_t p = 0; p < points.node.size(); ++p) {
        const auto n = static_cast<std::size_t>(points.node[p]);
        const Index texture = points.texture_point[p];
        rows.position.push_back(position[n]);
        rows.displacement.push_back(position[n] - origin[n]);
        rows.velocity.push_back(velocity[n]);
        rows.stress.push_back(stress[n]);
        rows.texture_point.push_back(texture == no_index
                                         ? std::array<Real, 2>{}
                                         : visual.surface.texture_points[static_cast<std::size_t>(texture)]);
    }
    for (const auto& [a, b, c] : points.triangles) rows.triangles.push_back({first + a, first + b, first + c});
    const std::size_t triangles = rows.triangles.size();
    rows.body.resize(triangles, bodies.number.at(body.handle));
    const auto first_material = static_cast<Index>(rows.material_names.size());
    for (const Index material : visual.surface.material)
        rows.material.push_back(material == no_index ? no_index : first_material + material);
    rows.material.resize(triangles, no_index);
    for (const VisualMaterial& material : visual.surface.materials) rows.material_names.push_back(material.name);
}

}  // namespace

void write_visuals(const Frame& frame, const SeriesBodies& bodies, const std::filesystem::path& file_path) {
    VisualRows rows;
    for (const BodyFrame& body : frame.bodies)
        if (body.visual) append_visual(body, bodies, rows);
    const auto same = [](const auto& value) { return value; };
    VtkFile file("PolyData", frame.time,
                 {{"body_names", bodies.names}, {"visual_material_names", rows.material_names}});
    file.open("Piece",
              count_attribute("Points", rows.position.size()) + count_attribute("Polys", rows.triangles.size()));
    file.open("Points");
    file.array<double>("Points", 3, rows.position.size(), [&](auto put) {
        for (const Vec3& point : rows.position) put_vector(put, point);
    });
    file.close("Points");
    file.open("Polys");
    file.array<std::int32_t>("connectivity", 1, 3 * rows.triangles.size(), [&](auto put) {
        for (const auto& triangle : rows.triangles)
            for (const Index point : triangle) put(point);
    });
    offsets(file, rows.triangles.size(), 3);
    file.close("Polys");
    file.open("PointData", "TCoords=\"texture_coordinates\"");
    file.array<float>("texture_coordinates", 2, rows.texture_point.size(), [&](auto put) {
        for (const auto& [u, v] : rows.texture_point) {
            put(u);
            put(v);
        }
    });
    vectors(file, "displacement", rows.displacement, same);
    vectors(file, "velocity", rows.velocity, same);
    file.array<float>("stress", 6, rows.stress.size(), [&](auto put) {
        for (const Mat3& stress : rows.stress) put_symmetric(put, stress);
    });
    scalars<float>(file, "von_mises", rows.stress, [](const Mat3& stress) { return von_mises(stress); });
    file.close("PointData");
    file.open("CellData");
    scalars<std::int32_t>(file, "body", rows.body, same);
    scalars<std::int32_t>(file, "visual_material", rows.material, same);
    file.close("CellData");
    file.close("Piece");
    file.write(file_path);
}

}  // namespace skerry
