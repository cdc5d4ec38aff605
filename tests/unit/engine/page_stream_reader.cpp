#include "page_stream_reader.h"

#include <zlib.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

namespace skerry {
namespace {

using Codes = std::vector<std::int64_t>;
constexpr Real last_code = 2047;

class Bytes {
public:
    explicit Bytes(const std::string& bytes) : bytes_(bytes) {}

    bool ended() const { return at_ == bytes_.size(); }
    template <class T>
    T raw() {
        if (at_ + sizeof(T) > bytes_.size()) throw std::runtime_error("a frame ends early");
        T value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    std::int64_t count() {
        std::int64_t value = 0, scale = 1;
        for (;;) {
            const auto byte = raw<unsigned char>();
            value += (byte % 128) * scale;
            if (byte < 128) return value;
            scale *= 128;
        }
    }
    std::int64_t change() { return signed_of(count()); }
    static std::int64_t signed_of(std::int64_t zigzag) { return zigzag % 2 ? -(zigzag + 1) / 2 : zigzag / 2; }

private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

/// State that is carried from one frame of a body to the next.
struct Track {
    Codes now, before;
    int frames = 0;
    std::array<Codes, read_field_count> code;
    std::array<std::int64_t, read_field_count> exponent{};
};

std::int64_t halved(std::int64_t code, std::int64_t times) {
    for (; times > 0 && code != 0 && code != -1; --times) code = (code - (code & 1)) / 2;
    return code;
}

Real value_of(std::int64_t code, std::int64_t exponent) {
    const Real part = static_cast<Real>(code) / last_code;
    return std::copysign(part * part, part) * std::pow(4.0, static_cast<Real>(exponent));
}

ReadShape read_shape(Bytes& in) {
    ReadShape shape;
    shape.node.resize(static_cast<std::size_t>(in.count()));
    shape.triangles.resize(static_cast<std::size_t>(in.count()));
    for (int axis = 0; axis < 3; ++axis) shape.origin[axis] = in.raw<double>();
    shape.step = in.raw<double>();
    Index last = 0;
    for (Index& node : shape.node) node = last += static_cast<Index>(in.change());
    last = 0;
    for (auto& triangle : shape.triangles)
        for (Index& corner : triangle) corner = last += static_cast<Index>(in.change());
    return shape;
}

ReadBody read_body(Bytes& in, std::size_t number, const ReadShape& shape, Track& track,
                   const std::array<std::int64_t, read_field_count + 1>& exponents) {
    const std::size_t count = shape.node.size();
    ReadBody body{.number = number, .position = std::vector<Vec3>(count), .value = {}};
    Codes next(3 * count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::int64_t rest = 0;
        for (std::size_t i = axis; i < next.size(); i += 3) {
            rest += in.change();
            next[i] = track.now[i] + rest + (track.frames > 1 ? track.now[i] - track.before[i] : 0);
            body.position[i / 3][static_cast<Index>(axis)] =
                shape.origin[static_cast<Index>(axis)] + shape.step * static_cast<Real>(next[i]);
        }
    }
    track.before = track.now;
    track.now = next;
    ++track.frames;

    const auto sum = [](const Codes& codes) {
        std::int64_t all = 0;
        for (const std::int64_t code : codes) all += code;
        return all;
    };
    const std::array<std::int64_t, 3> sums{sum(track.code[0]), sum(track.code[1]), sum(track.code[2])};
    Codes stress_change(count);
    for (std::size_t field = 0; field < read_field_count; ++field) {
        std::int64_t rest = 0;
        for (std::size_t i = 0; i < count; ++i) {
            rest += in.change();
            std::int64_t change = rest;
            if (field == 2 && sums[1] > 0)
                change += static_cast<std::int64_t>(std::floor(
                    static_cast<Real>(stress_change[i]) * (static_cast<Real>(sums[2]) / static_cast<Real>(sums[1])) +
                    0.5));
            if (field == 1) stress_change[i] = change;
            std::int64_t& code = track.code[field][i];
            code = halved(code, exponents[field] - track.exponent[field]) + change;
            body.value[field].push_back(value_of(code, exponents[field]));
        }
        track.exponent[field] = exponents[field];
    }
    return body;
}

struct ContactTrack {
    std::vector<ReadContact> rows;
    std::vector<std::array<std::int64_t, 7>> codes;
    std::int64_t exponent = 0;
};

void read_contacts(Bytes& in, std::size_t count, const ReadRun& run, const std::vector<Track>& tracks,
                   std::int64_t exponent, ContactTrack& track, ReadFrame& frame) {
    std::vector<ReadContact> rows(count);
    std::int64_t expected = 0;
    for (ReadContact& row : rows) {
        const std::int64_t mark = in.count();
        row.row_prev = mark == 0 ? -1 : static_cast<int>(expected + Bytes::signed_of(mark - 1));
        if (mark != 0) expected = row.row_prev + 1;
    }
    for (ReadContact& row : rows) {
        if (row.row_prev >= 0) {
            const ReadContact& prev = track.rows.at(static_cast<std::size_t>(row.row_prev));
            row.first = prev.first, row.second = prev.second, row.collider = prev.collider;
        } else {
            for (Index* side : {&row.first, &row.second, &row.collider}) *side = static_cast<Index>(in.count() - 1);
        }
    }
    std::vector<std::array<std::int64_t, 7>> codes(count);
    for (std::size_t k = 0; k < 7; ++k)
        for (std::size_t i = 0; i < count; ++i) {
            const ReadContact& row = rows[i];
            const Index body = row.first >= 0 ? row.first : row.second;
            std::int64_t base = 0;
            if (row.row_prev >= 0) {
                base = track.codes[static_cast<std::size_t>(row.row_prev)][k];
                if (k >= 3) base = halved(base, exponent - track.exponent);
            } else if (i > 0 && row.first >= 0 && rows[i - 1].first == row.first) {
                base = codes[i - 1][k];
            } else if (k < 3 && body >= 0) {
                base = tracks.at(static_cast<std::size_t>(body)).now[k];
            }
            codes[i][k] = base + in.change();
        }
    Index region = 0;
    for (ReadContact& row : rows) row.region = region += static_cast<Index>(in.change());
    for (ReadContact& row : rows) row.state = in.raw<unsigned char>();
    for (std::size_t i = 0; i < count; ++i) {
        ReadContact& row = rows[i];
        const Index body = row.first >= 0 ? row.first : row.second;
        const Vec3 origin = body >= 0 ? run.shapes[static_cast<std::size_t>(body)].origin : Vec3(Vec3::Zero());
        const Real step = body >= 0 ? run.shapes[static_cast<std::size_t>(body)].step : 1e-6;
        for (Index axis = 0; axis < 3; ++axis) {
            row.point[axis] = origin[axis] + step * static_cast<Real>(codes[i][static_cast<std::size_t>(axis)]);
            row.force[axis] = value_of(codes[i][static_cast<std::size_t>(3 + axis)], exponent);
        }
        row.normal_force = value_of(codes[i][6], exponent);
    }
    track = {rows, codes, exponent};
    frame.contacts = std::move(rows);
}

struct LineTrack {
    std::map<std::size_t, std::vector<std::array<std::int64_t, 4>>> codes;
    std::int64_t exponent = 0;
};

void read_lines(Bytes& in, ReadRun& run, LineTrack& track, ReadFrame& frame) {
    LineTrack now{.codes = {}, .exponent = track.exponent};
    const std::int64_t count = in.count();
    if (count > 0) {
        now.exponent = in.change();
        frame.top_of_lines = std::pow(4.0, static_cast<Real>(now.exponent));
    }
    if (count > 0 && run.step_of_lines == 0) {
        for (int axis = 0; axis < 3; ++axis) run.origin_of_lines[axis] = in.raw<double>();
        run.step_of_lines = in.raw<double>();
    }
    for (std::int64_t i = 0; i < count; ++i) {
        ReadLine line{.number = static_cast<std::size_t>(in.count())};
        auto& codes = now.codes[line.number];
        codes.resize(static_cast<std::size_t>(in.count()));
        const auto prev = track.codes.find(line.number);
        const bool continues = prev != track.codes.end() && prev->second.size() == codes.size();
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t p = 0; p < codes.size(); ++p) {
                std::int64_t base = p > 0 ? codes[p - 1][k] : 0;
                if (continues) base = prev->second[p][k];
                if (continues && k == 3) base = halved(base, now.exponent - track.exponent);
                codes[p][k] = base + in.change();
            }
        for (const auto& [x, y, z, force] : codes) {
            line.points.push_back(run.origin_of_lines + run.step_of_lines * Vec3(static_cast<Real>(x),
                                                                                 static_cast<Real>(y),
                                                                                 static_cast<Real>(z)));
            line.force.push_back(value_of(force, now.exponent));
        }
        frame.lines.push_back(std::move(line));
    }
    track = std::move(now);
}

Codes read_changes(Bytes& in, std::size_t count) {
    Codes values(count);
    std::int64_t last = 0;
    for (std::int64_t& value : values) value = last += in.change();
    return values;
}

std::vector<std::array<Index, 3>> read_corners(Bytes& in, std::size_t triangles) {
    const Codes values = read_changes(in, 3 * triangles);
    std::vector<std::array<Index, 3>> corners(triangles);
    for (std::size_t i = 0; i < values.size(); ++i) corners[i / 3][i % 3] = static_cast<Index>(values[i]);
    return corners;
}

ReadVisual read_visual(Bytes& in) {
    constexpr Real part = 1.0 / 65536;
    const auto size = [&] { return static_cast<std::size_t>(in.count()); };
    const std::size_t nodes = size(), triangles = size(), points = size(), materials = size();
    ReadVisual visual;
    visual.node.resize(nodes);
    visual.weight.resize(nodes);
    visual.offset.resize(nodes);
    visual.texture_points.resize(points);
    const auto step = in.raw<double>();
    const auto by_node = [&](auto&& put) {
        const Codes values = read_changes(in, nodes);
        for (std::size_t i = 0; i < nodes; ++i) put(i, values[i]);
    };
    for (std::size_t k = 0; k < 4; ++k)
        by_node([&](std::size_t i, std::int64_t value) { visual.node[i][k] = static_cast<Index>(value); });
    for (std::size_t k = 0; k < 3; ++k)
        by_node([&](std::size_t i, std::int64_t value) { visual.weight[i][k] = part * static_cast<Real>(value); });
    for (auto& weight : visual.weight) weight[3] = 1 - weight[0] - weight[1] - weight[2];
    for (Index axis = 0; axis < 3; ++axis)
        by_node([&](std::size_t i, std::int64_t value) { visual.offset[i][axis] = step * static_cast<Real>(value); });
    Index node = 0;
    for (std::int64_t count = in.count(); count > 0; --count) {
        Index term = node += static_cast<Index>(in.change());
        auto& terms = visual.gradient[node];
        terms.resize(size());
        for (auto& [of, gradient] : terms) {
            of = term += static_cast<Index>(in.change());
            for (Index axis = 0; axis < 3; ++axis) gradient[axis] = in.raw<float>();
        }
    }
    visual.triangles = read_corners(in, triangles);
    for (std::size_t k = 0; k < 2 && points > 0; ++k) {
        const Codes values = read_changes(in, points);
        for (std::size_t i = 0; i < points; ++i) visual.texture_points[i][k] = part * static_cast<Real>(values[i]);
    }
    if (points > 0) visual.texture_corners = read_corners(in, triangles);
    if (materials > 0)
        for (const std::int64_t material : read_changes(in, triangles))
            visual.material.push_back(static_cast<Index>(material));
    return visual;
}

}  // namespace

std::vector<Vec3> ReadVisual::positions(std::span<const Vec3> of_body) const {
    std::vector<Vec3> positions(node.size(), Vec3::Zero());
    for (std::size_t i = 0; i < node.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k) {
            positions[i] += weight[i][k] * of_body[static_cast<std::size_t>(node[i][k])];
            if (offset[i].isZero(0) || weight[i][k] == 0) continue;
            for (const auto& [of, g] : gradient.at(node[i][k]))
                positions[i] += weight[i][k] * g.dot(offset[i]) * of_body[static_cast<std::size_t>(of)];
        }
    return positions;
}

std::vector<ReadVisual> read_visuals(const std::string& packed) {
    const std::string bytes = inflate_all(packed);
    Bytes in(bytes);
    std::vector<ReadVisual> visuals;
    while (!in.ended()) visuals.push_back(read_visual(in));
    return visuals;
}

std::string inflate_all(const std::string& packed) {
    z_stream z{};
    if (inflateInit(&z) != Z_OK) throw std::runtime_error("zlib does not start");
    z.next_in = reinterpret_cast<unsigned char*>(const_cast<char*>(packed.data()));
    z.avail_in = static_cast<uInt>(packed.size());
    std::string out;
    std::array<unsigned char, 4096> room;
    int status = Z_OK;
    while (status == Z_OK) {
        z.next_out = room.data();
        z.avail_out = static_cast<uInt>(room.size());
        status = inflate(&z, Z_NO_FLUSH);
        out.append(reinterpret_cast<const char*>(room.data()), room.size() - z.avail_out);
    }
    inflateEnd(&z);
    if (status != Z_STREAM_END || z.avail_in != 0) throw std::runtime_error("no whole zlib stream");
    return out;
}

ReadRun read_run(const std::string& packed) {
    return read_frames(inflate_all(packed));
}

ReadRun read_frames(const std::string& bytes) {
    Bytes in(bytes);
    ReadRun run;
    std::vector<Track> tracks;
    ContactTrack contacts;
    LineTrack lines;
    while (!in.ended()) {
        ReadFrame frame;
        const std::int64_t body_count = in.count(), collider_count = in.count(), contact_count = in.count();
        std::array<std::int64_t, read_field_count + 1> exponents;
        for (std::size_t i = 0; i < exponents.size(); ++i) {
            exponents[i] = in.change();
            frame.top[i] = std::pow(4.0, static_cast<Real>(exponents[i]));
        }
        for (std::int64_t i = 0; i < body_count; ++i) {
            const auto number = static_cast<std::size_t>(in.count());
            if (number == run.shapes.size()) {
                run.shapes.push_back(read_shape(in));
                const std::size_t count = run.shapes.back().node.size();
                tracks.push_back({.now = Codes(3 * count), .before = Codes(3 * count), .code = {}});
                tracks.back().code.fill(Codes(count));
            }
            frame.bodies.push_back(read_body(in, number, run.shapes.at(number), tracks[number], exponents));
        }
        for (std::int64_t i = 0; i < collider_count; ++i) {
            frame.colliders.push_back(static_cast<std::size_t>(in.count()));
            for (int k = 0; k < 6; ++k) in.raw<float>();
        }
        read_contacts(in, static_cast<std::size_t>(contact_count), run, tracks, exponents.back(), contacts, frame);
        read_lines(in, run, lines, frame);
        run.frames.push_back(std::move(frame));
    }
    return run;
}

}  // namespace skerry
