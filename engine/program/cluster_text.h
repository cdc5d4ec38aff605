// Text about clusters of elements, for the output of the program.
#pragma once

#include <string>

#include "engine/program/number_text.h"
#include "skerry/report.h"

namespace skerry {

inline std::string cluster_text(const WorldReport& report) {
    return grouped(report.implicit_elements) + " implicit elements move " + grouped(report.cluster_nodes) +
           " nodes in " + grouped(report.clusters) + (report.clusters == 1 ? " cluster" : " clusters") +
           (report.guards > 0 ? ", " + grouped(report.guards) + " of whose tetrahedra have guards" : "");
}

}  // namespace skerry
