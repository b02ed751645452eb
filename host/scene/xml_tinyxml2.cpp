// XML by tinyxml2.
#include <fmt/format.h>
#include <tinyxml2.h>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/xml.h"

namespace scree {
namespace {

// Its depth is bounded: tinyxml2 refuses elements that are nested too deep.
XmlElement tree_of(const tinyxml2::XMLElement& from) {
  XmlElement element{from.Name(), from.GetLineNum(), {}, {}};
  for (auto* a = from.FirstAttribute(); a != nullptr; a = a->Next())
    element.attributes.emplace_back(a->Name(), a->Value());
  for (auto* child = from.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement())
    element.children.push_back(tree_of(*child));
  return element;
}

}  // namespace

XmlElement parse_xml(const std::string& text, const std::string& file_name) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(fmt::format("{}: line {}: broken XML ({})", file_name, document.ErrorLineNum(),
                                 printable(document.ErrorName(), 60)));
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr) throw InputError(file_name + ": no XML element");
  return tree_of(*root);
}

}  // namespace scree
