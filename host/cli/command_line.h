#pragma once
// The command line of the program: which options each command has. All sources that need CLI11, which takes long to compile, are
// this one's and that of `scree bench`.

#include <string>

#include "host/cli/options.h"

namespace CLI {
class App;
}

namespace scree {

/// Reads the command line and does what it asks for. @return exit code: 0 done, 1 the run failed, 2 bad command line
/// @throws what the command throws, InputError for bad input
int run_command_line(int argc, char** argv);

/// One line on standard error. @return the exit code given
int fail(const std::string& what, int code);

/// Adds --backend, --device, --precision and --threads to a command.
/// @param backend, precision, threads  what is taken by default, for the help text
void add_device_options(CLI::App& command, RunTarget& target, const std::string& backend,
                        const std::string& precision, const std::string& threads = "all");

/// The same, --memory and --set.
void add_backend_options(CLI::App& command, RunTarget& target, const std::string& backend,
                         const std::string& precision);

/// Adds SCENE and the options above to a command.
void add_target_options(CLI::App& command, RunTarget& target);

/// Adds --transport, to commands that several ranks run together.
void add_transport_option(CLI::App& command, RunTarget& target);

}  // namespace scree
