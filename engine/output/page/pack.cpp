#include "engine/output/page/pack.h"

namespace skerry {

void put_points(std::string& out, std::span<const Vec3> points) {
    Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
    bool first = true;
    for (const Vec3& point : points) {
        if (!point.allFinite()) continue;
        lower = first ? point : Vec3(lower.cwiseMin(point));
        upper = first ? point : Vec3(upper.cwiseMax(point));
        first = false;
    }
    const Vec3 extent = upper - lower;
    put_floats(out, lower);
    put_floats(out, extent);
    for (const Vec3& point : points)
        for (int axis = 0; axis < 3; ++axis) put(out, code_of<std::uint16_t>(point[axis] - lower[axis], extent[axis]));
    fill_up(out);
}

std::string base64(std::string_view bytes) {
    static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    const auto byte = [&](std::size_t i) {
        return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0u;
    };
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        text += letters[group >> 18];
        text += letters[group >> 12 & 63];
        text += i + 1 < bytes.size() ? letters[group >> 6 & 63] : '=';
        text += i + 2 < bytes.size() ? letters[group & 63] : '=';
    }
    return text;
}

}  // namespace skerry
