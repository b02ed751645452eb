#include "host/scene/body_name.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/io/printable.h"

namespace scree {

std::string body_name(const BodyConstants& body, int id, const std::map<std::string, int>& names) {
  const BodyConstant constant = body[static_cast<std::size_t>(id)];
  std::string text = fmt::format("body {}", id);
  if (constant.entry >= 0)
    text = constant.is_particle ? fmt::format("particles[{}] #{}", constant.entry, constant.number)
                                : fmt::format("bodies[{}]", constant.entry);
  const auto named =
      std::find_if(names.begin(), names.end(), [&](const auto& each) { return each.second == id; });
  if (named != names.end()) text += fmt::format(" \"{}\"", printable(named->first, 80));
  return text;
}

std::string body_with_id(const BodyConstants& body, int id) {
  return id < 0 ? "the world" : fmt::format("{} (id {})", body_name(body, id), id);
}

}  // namespace scree
