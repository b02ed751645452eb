#include "host/io/seal.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/checksum.h"

namespace scree {
namespace {

/// Length and checksum of what follows the seal. @return false when the file cannot be read
bool measure(std::istream& file, std::uint64_t* bytes, std::uint64_t* checksum) {
  Checksum sum;
  std::vector<char> block(std::size_t{1} << 20);
  *bytes = 0;
  for (;;) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    if (count == 0) break;
    sum.add(std::string_view(block.data(), count));
    *bytes += count;
  }
  *checksum = sum.value();
  return file.eof();
}

/// The whole seal.
std::string seal_text(const std::string& kind, int version, std::uint64_t bytes,
                      std::uint64_t checksum) {
  std::string text =
      fmt::format("{}\nversion {}\nbytes {}\nchecksum {:016x}\n", kind, version, bytes, checksum);
  text.resize(seal_bytes, '\0');
  return text;
}

}  // namespace

void write_seal(const std::filesystem::path& path, const std::string& kind, int version) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(static_cast<std::streamoff>(seal_bytes));
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;
  if (!file || !measure(file, &bytes, &checksum))
    throw RunError(io_message("cannot read", path, errno));
  file.clear();
  const std::string text = seal_text(kind, version, bytes, checksum);
  file.seekp(0);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.flush();
  if (!file) throw RunError(io_message("cannot write", path, errno));
}

bool has_seal(const std::filesystem::path& path, const std::string& kind) {
  const std::string start = kind + "\nversion ";
  std::string found(start.size(), '\0');
  std::ifstream(path, std::ios::binary)
      .read(found.data(), static_cast<std::streamsize>(found.size()));
  return found == start;
}

std::string check_seal(const std::filesystem::path& path, const std::string& kind, int version,
                       int first_version) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::generic_category().message(errno);
  std::string seal(seal_bytes, '\0');
  file.read(seal.data(), static_cast<std::streamsize>(seal.size()));
  const auto count = static_cast<std::size_t>(file.gcount());
  if (count == 0) return "it is empty";
  if (seal.starts_with("\x89HDF\r\n\x1a\n")) return "it is an HDF5 file of another kind";
  const std::string start = kind + "\nversion ";
  if (!seal.starts_with(start)) return "it is a file of another kind";
  if (count < seal_bytes) return fmt::format("it is cut off after {} bytes", count);

  std::istringstream fields(seal.substr(kind.size()));
  std::string word;
  int found_version = 0;
  std::uint64_t expected_bytes = 0;
  std::string expected_checksum;
  fields >> word >> found_version;
  const int least_version = first_version > 0 ? first_version : version;
  if (fields && (found_version < least_version || found_version > version))
    return fmt::format("it has format version {}", found_version);
  fields >> word >> expected_bytes >> word >> expected_checksum;
  if (!fields) return "its seal is damaged";
  std::uint64_t bytes = 0;
  std::uint64_t checksum = 0;
  if (!measure(file, &bytes, &checksum)) return std::generic_category().message(errno);
  if (bytes != expected_bytes)
    return fmt::format("it has {} bytes where {} should be", bytes + seal_bytes,
                       expected_bytes + seal_bytes);
  if (seal != seal_text(kind, found_version, bytes, checksum))
    return fmt::format("it is damaged: its checksum is {:016x}, its seal says {}", checksum,
                       expected_checksum);
  return {};
}

}  // namespace scree
