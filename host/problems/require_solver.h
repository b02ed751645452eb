#pragma once
// Whether a solver of steps can do what it is asked for.

#include <string>

#include "host/world.h"
#include "kernels/contact/contact_view.h"

namespace scree {

/// @param where  names the place of the solver's name in a message
/// @throws InputError when the solver does not run on the backend, or does not know such contacts
void require_solver(const std::string& where, const std::string& name, BackendKind backend,
                    ContactLayout layout);

}  // namespace scree
