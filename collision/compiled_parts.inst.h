// What the library of collision has compiled for the backend that is named BuildBackend: sources that include this call it, and
// do not compile it again.

#include "collision/body_order.h"
#include "collision/contact_detector.h"

namespace scree {

extern template class PairCandidates<BuildBackend, float>;
extern template class PairCandidates<BuildBackend, double>;
extern template class PersistentContacts<BuildBackend, float>;
extern template class PersistentContacts<BuildBackend, double>;
extern template class ContactDetector<BuildBackend, float>;
extern template class ContactDetector<BuildBackend, double>;
extern template class BodyOrder<BuildBackend>;

}  // namespace scree
