#include <fmt/format.h>

#include "bench/timer.h"
#include "host/cli/progress.h"
#include "host/world.h"
#include "scenes/wall.h"
