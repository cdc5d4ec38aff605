// JSON document of a study.
#pragma once

#include "engine/scene/place.h"
#include "skerry/study.h"

namespace skerry {

/// All numbers of a study except the time series of its runs. Scripts rely on the names of the keys.
Json study_json(const StudyResult& result);

}  // namespace skerry
