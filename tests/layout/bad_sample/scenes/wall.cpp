#include "scenes/wall.h"

#include "host/io/writer.h"
#include "host/world.h"
#include "kernels/types.h"
