#pragma once
// Names of parts of bodies that outlive their places in storage: those by which saved contacts know them, whatever the number
// of ranks.

#include <utility>
#include <vector>

#include "kernels/types.h"

namespace scree {

/// The first part of a body is known by the id of the body, and so is a body without parts. Others come behind all ids, in
/// the order of the scene.
struct PartNames {
  Index id_count = 0;        ///< of all bodies that there can ever be
  std::vector<Index> owner;  ///< [parts of all compounds] id of the body of each

  /// Of a part that is not the first of its body. @param number  among the parts of all compounds
  Index of(Index number) const { return id_count + number; }
  /// End of all names.
  Index end() const { return of(static_cast<Index>(owner.size())); }
  /// Id of the body that a name is of; -1: it is not one of a part.
  Index body(Index name) const {
    if (name < 0 || name >= end()) return -1;
    return name < id_count ? name : owner[static_cast<std::size_t>(name - id_count)];
  }
};

}  // namespace scree
