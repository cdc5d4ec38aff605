#include "engine/world/world_state.h"
