// A synthetic run with a known value for every number: balls that fall into a bucket and wobble, without a World.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/page_document.h"

namespace skerry {

/// Balls with a centre node and an icosahedron around it, refined `level` times: 10 * 4^level + 2 surface nodes. Ball 1
/// is added at a third of the run, ball 0 removed at two thirds. Colliders: plane, bucket, moving box, capsule, mesh.
/// Lines: a cable from a fixed point through the centres of all balls, a spring with a force of either sign, a tie
/// whose nodes break off one by one, and a joint in the second half of the run.
class OutputSample {
public:
    OutputSample(int ball_count, int level, int frame_count);

    int frame_count() const { return frame_count_; }
    /// Frame `number`; the reference is valid until the next call.
    const Frame& frame(int number);
    PageSummary summary() const;

private:
    void place_ball(int ball, Real time);
    void add_contacts(int ball, Real time);
    void add_lines(int number);

    struct Ball {
        std::string name;
        Vec3 home;   // point of the floor under its centre [m]
        Real phase;  // [s]
        std::vector<Vec3> position, velocity;
        std::vector<Mat3> stress, strain;  // by tetrahedron
    };
    int frame_count_;
    std::vector<Vec3> direction_;  // unit vectors to the nodes of a ball, the centre first
    std::vector<std::array<Index, 3>> surface_;
    std::vector<std::array<Index, 4>> tetrahedra_;
    std::vector<Ball> balls_;
    std::vector<Contact> contacts_;
    std::deque<Shape> shapes_;
    Frame frame_;
};

}  // namespace skerry
