#include "host/io/printable.h"

#include <fmt/format.h>

namespace scree {

std::string printable(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (out.size() >= most) return out + "...";
    const auto c = static_cast<unsigned char>(text[i]);
    // In UTF-8 the control characters U+0080 to U+009F are C2 80 to C2 9F.
    const bool leads_control = c == 0xc2 && i + 1 < text.size() &&
                               static_cast<unsigned char>(text[i + 1]) >= 0x80 &&
                               static_cast<unsigned char>(text[i + 1]) < 0xa0;
    if (c < 0x20 || c == 0x7f || leads_control) {
      out += fmt::format("\\x{:02x}", c);
      if (leads_control) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
    } else {
      out += text[i];
    }
  }
  return out;
}

}  // namespace scree
