#include "bench/timer.h"
#include "host/cli/progress.h"
#include "scenes/wall.h"
