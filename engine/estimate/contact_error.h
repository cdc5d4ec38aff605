// Error of the contact forces on bodies that is due to the tolerance of the solver.
#pragma once

#include <map>
#include <vector>

#include "skerry/estimate.h"

namespace skerry {

/// For each body: the relative solver error e_nat of its contact regions (docs/methods/errors.md 2), and the largest
/// overlap and gap of its contacts. The solver error is a mean over the contacts of the body, weighted by their
/// impulses.
class ContactError {
public:
    /// Takes a sample from the contacts of the last step.
    void sample(const World& world);
    /// Sets ErrorEstimate::contact, overlap and gap of the bodies that were touched.
    void add_to(std::vector<ErrorEstimate>& bodies) const;

private:
    struct Touched {
        Real impulse = 0;  // sum of the impulses of the contacts of the body [N s]
        Real error = 0;    // sum of impulse times error of the region over these contacts [N s]
        Real overlap = 0;  // largest overlap [m]
        Real gap = 0;      // largest distance of a contact that carried a force [m]
    };

    std::map<BodyHandle, Touched> touched_;
};

}  // namespace skerry
