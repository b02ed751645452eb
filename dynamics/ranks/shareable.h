#pragma once
// What scenes on several ranks may have.

#include "host/scene.h"

namespace scree {

/// @throws InputError naming what of a scene one rank simulates only
void require_shareable(const Scene& scene);

/// @throws InputError saying that a call of World is for one rank only
[[noreturn]] void throw_not_over_ranks(const char* call);

}  // namespace scree
