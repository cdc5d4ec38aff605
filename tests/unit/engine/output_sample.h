// A made-up run with a known answer for every number: balls that fall into a bucket and wobble, without a World.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "engine/output/frame.h"
#include "engine/output/page/page_document.h"

namespace skerry {

/// Balls of a centre node and `level` times refined icosahedra around it: 10 * 4^level + 2 surface nodes. Ball 1 is
/// added at a third of the run, ball 0 removed at two thirds. A plane, a bucket, a box that moves, a capsule.
class OutputSample {
public:
    OutputSample(int ball_count, int level, int frame_count);

    int frame_count() const { return frame_count_; }
    /// Valid until the next call.
    const Frame& frame(int number);
    PageSummary summary() const;

private:
    void place_ball(int ball, Real time);
    void add_contacts(int ball, Real time);

    struct Ball {
        std::string name;
        Vec3 home;   // m, of the floor under its centre
        Real phase;  // s
        std::vector<Vec3> position, velocity;
        std::vector<Mat3> stress, strain;  // by tetrahedron
    };
    int frame_count_;
    std::vector<Vec3> direction_;  // of the nodes of a ball, the centre first
    std::vector<std::array<Index, 3>> surface_;
    std::vector<std::array<Index, 4>> tetrahedra_;
    std::vector<Ball> balls_;
    std::vector<Contact> contacts_;
    std::deque<Shape> shapes_;
    Frame frame_;
};

}  // namespace skerry
