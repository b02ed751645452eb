#pragma once
// Lists of words, for messages.

#include <string>

namespace scree {

/// "a, b, c", each word between quotes.
template <class Words>
std::string joined(const Words& words, const char* quote = "") {
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : ", ") + (quote + std::string(word)) + quote;
  return text;
}

}  // namespace scree
