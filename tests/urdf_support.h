#pragma once
// Whether this program reads URDF files: tinyxml2 is optional.

#include "host/error.h"
#include "host/scene/xml.h"

namespace scree::test {

inline bool reads_urdf() {
  try {
    parse_xml("<a/>", "a");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace scree::test
