#pragma once
// What messages call a body.

#include <map>
#include <string>

#include "host/body_constants.h"

namespace scree {

/// A body as its scene file lists it, such as "bodies[3]" or "particles[0] #12"; by its id when the
/// scene comes from no file. Its name follows where it has one: bodies[3] "lid".
/// @param names  see Scene::body_names
std::string body_name(const BodyConstants& body, int id,
                      const std::map<std::string, int>& names = {});
/// The same with its id, or "the world".
std::string body_with_id(const BodyConstants& body, int id);

}  // namespace scree
