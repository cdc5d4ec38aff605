#include "engine/world/step/seams.h"
#include "engine/world/step/step.h"

namespace skerry {

void note_forces(Model& model) {
    model.forced = false;
    model.force_rate.clear();
    for (const ForceElement* element : force_elements) {
        if (!element->any(model)) continue;
        model.forced = true;
        if (!element->add_rate) continue;
        model.force_rate.resize(model.bodies.slot.size());
        element->add_rate(model, model.force_rate);
    }
}

}  // namespace skerry
