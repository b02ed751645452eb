#pragma once
// The part of scenes/schema.json that tells the solvers of steps: what their cards say.

#include "host/scene_reader/json_text.h"

namespace scree::reader {

/// The schema with the solvers of this program and their parameters.
/// @param schema  the document of scenes/schema.json
Json schema_with_solvers(Json schema);

}  // namespace scree::reader
