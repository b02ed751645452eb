#pragma once
#include "kernels/contact/contact_view.h"
#include "kernels/narrow_phase/walls.h"
#include "kernels/solve/momentum.h"
#include "kernels/types.h"
