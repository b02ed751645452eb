#pragma once
// scree info: devices, build options and versions.

#include <CLI/CLI.hpp>

namespace scree {

struct InfoOptions {
  bool json = false;
};

CLI::App* add_info_command(CLI::App& app, InfoOptions& options);
int print_info(const InfoOptions& options);

}  // namespace scree
