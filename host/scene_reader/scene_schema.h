#pragma once
// The parts of scenes/schema.json that tell the solvers of steps, the models of dynamics and the
// shapes: what their cards say.

#include "host/scene_reader/json_text.h"

namespace scree::reader {

/// The schema with the solvers and models of this program, their parameters, and its shapes.
/// @param schema  the document of scenes/schema.json
Json schema_with_cards(Json schema);

}  // namespace scree::reader
