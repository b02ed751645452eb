#pragma once
// scree check: validates a scene and says what a run would take, without running it.

#include "host/cli/options.h"

namespace scree {

struct CheckOptions {
  RunTarget target;
};

int check_scene(const CheckOptions& options);

}  // namespace scree
