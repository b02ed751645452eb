#pragma once
// A 64-bit checksum that tells files apart that were damaged; not for use against malice.

#include <cstdint>
#include <cstring>
#include <string_view>

namespace scree {

/// FNV-1a over 64-bit words, with a shift after each product so that high bits spread downwards
/// too. Each step is a bijection of the state: one damaged word always changes the result.
class Checksum {
 public:
  void add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x100000001b3u;
    state_ ^= state_ >> 32;
  }
  void add(std::string_view bytes) {
    add(static_cast<std::uint64_t>(bytes.size()));
    for (; bytes.size() >= sizeof(std::uint64_t); bytes.remove_prefix(sizeof(std::uint64_t)))
      add(word(bytes, sizeof(std::uint64_t)));
    if (!bytes.empty()) add(word(bytes, bytes.size()));
  }
  std::uint64_t value() const { return state_; }

 private:
  static std::uint64_t word(std::string_view bytes, std::size_t count) {
    std::uint64_t out = 0;
    std::memcpy(&out, bytes.data(), count);
    return out;
  }
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace scree
