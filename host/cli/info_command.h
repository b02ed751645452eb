#pragma once
// scree info: devices, build options, versions; the schema of scene files.

#include <CLI/CLI.hpp>

namespace scree {

struct InfoOptions {
  bool json = false;
  bool schema = false;  ///< of scene files, in place of the rest
};

CLI::App* add_info_command(CLI::App& app, InfoOptions& options);
int print_info(const InfoOptions& options);

}  // namespace scree
