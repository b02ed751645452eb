// Compiled once per backend, which the build names BuildBackend.
#include "host/render/renderer_impl.h"

namespace scree {
template class Renderer<BuildBackend, float>;
template class Renderer<BuildBackend, double>;
}  // namespace scree
