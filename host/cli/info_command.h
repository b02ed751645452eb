#pragma once
// scree info: devices, build options, versions; the schema of scene files.

namespace scree {

struct InfoOptions {
  bool json = false;
  bool schema = false;  ///< of scene files, in place of the rest
};

int print_info(const InfoOptions& options);

}  // namespace scree
