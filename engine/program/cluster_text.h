// Text about clusters of elements, for the output of the program.
#pragma once

#include <string>

#include "engine/output/number_text.h"
#include "skerry/report.h"

namespace skerry {

inline std::string cluster_text(const WorldReport& report) {
    return grouped(report.clusters) + (report.clusters == 1 ? " cluster of " : " clusters of ") +
           grouped(report.cluster_nodes) + " nodes and " + grouped(report.implicit_elements) + " implicit elements" +
           (report.guards > 0 ? "; inversion barriers on " + grouped(report.guards) + " tetrahedra" : "");
}

}  // namespace skerry
