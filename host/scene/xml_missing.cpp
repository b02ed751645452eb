// In place of xml_tinyxml2.cpp in builds without that library.
#include "host/error.h"
#include "host/scene/xml.h"

namespace scree {

XmlElement parse_xml(const std::string&, const std::string& file_name) {
  throw InputError(file_name +
                   ": this scree was built without tinyxml2 and reads no URDF; build it with the "
                   "library (Debian and Ubuntu package libtinyxml2-dev)");
}

}  // namespace scree
