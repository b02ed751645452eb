#pragma once
// The parts of scenes/schema.json that tell the solvers of steps, the models of dynamics and the
// shapes: what their cards say.

#include <vector>

#include "dynamics/dynamics_card.h"
#include "host/scene_reader/json_text.h"
#include "shapes/shape_card.h"

namespace scree::reader {

/// The schema with the solvers and models of this program, their parameters, and its shapes.
/// @param schema  the document of scenes/schema.json
Json schema_with_cards(Json schema);

/// What the schema says of the parameters of models, by key.
/// @throws std::logic_error naming the key and two models when their parameters of that key differ in
///         what they take or in the default: the schema has one entry for all of them
Json parameter_schemas(const std::vector<DynamicsCard>& cards);

/// @throws std::logic_error naming the key and two shapes when it has another type in each
void require_same_types(const std::vector<ShapeCard>& cards);

}  // namespace scree::reader
