// Compiled once per backend, which the build names BuildBackend.
#include "collision/body_order.h"
#include "collision/contact_detector.h"

namespace scree {

template class PairCandidates<BuildBackend, float>;
template class PairCandidates<BuildBackend, double>;
template class PersistentContacts<BuildBackend, float>;
template class PersistentContacts<BuildBackend, double>;
template class ContactDetector<BuildBackend, float>;
template class ContactDetector<BuildBackend, double>;
template class BodyOrder<BuildBackend>;

}  // namespace scree
