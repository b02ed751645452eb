#include "host/world_state.h"

#include "host/error.h"

namespace scree {

void WorldState::throw_no_array(const std::string& name) {
  throw InputError("checkpoint: array " + name + " is not there, or of another type");
}

}  // namespace scree
