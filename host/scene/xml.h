#pragma once
// XML documents as a tree of elements, whatever library reads them.

#include <string>
#include <utility>
#include <vector>

namespace scree {

struct XmlElement {
  std::string name;
  int line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;

  /// Null where there is none.
  const std::string* attribute(const char* key) const {
    for (const auto& [name_of_one, value] : attributes)
      if (name_of_one == key) return &value;
    return nullptr;
  }
};

/// The root element. Texts between elements and comments are left out.
/// @throws InputError naming file and line; also when scree was built without a library for XML
XmlElement parse_xml(const std::string& text, const std::string& file_name);

}  // namespace scree
