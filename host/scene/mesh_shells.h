#pragma once
// Whether the closed parts of a mesh are the surfaces of solids and of their cavities.

#include <optional>

#include "host/scene.h"

namespace scree {

/// A closed part of a mesh that is turned the wrong way for where it is.
struct WrongShell {
  int triangle = -1;  ///< the first one of the part
  bool is_outward =
      false;  ///< as a solid is: it is inside of another one, whose mass its inside counts in already
};

/// Of a closed mesh whose triangles do not cross: its first part that is no solid in the open or in a cavity, and no cavity in
/// a solid. A mesh that is inside out as a whole is as good as one that is not. What lies in the surface of another part, so
/// that it is not clear which side it is on, does not count.
std::optional<WrongShell> wrong_shell(const TriangleMesh& mesh);

}  // namespace scree
