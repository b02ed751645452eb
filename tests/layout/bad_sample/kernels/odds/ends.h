#pragma once
#include "kernels/types.h"
